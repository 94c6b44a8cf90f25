//! Files that the program writes, read back by programs that share no code with it: OpenEXR's library, Radiance, Mitsuba.

mod bsdf_exr;
mod colours;
mod command;
mod made;
mod measured;
mod mitsuba;
mod python;
mod radiance;
mod slices;
mod text;
