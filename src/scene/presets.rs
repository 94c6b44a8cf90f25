//! Cloth files that come with the program.

/// Names and texts of the presets.
pub const PRESETS: [(&str, &str); 13] = [
    ("charmeuse", include_str!("../../assets/cloths/charmeuse.toml")),
    ("denim", include_str!("../../assets/cloths/denim.toml")),
    ("dimout", include_str!("../../assets/cloths/dimout.toml")),
    ("felt", include_str!("../../assets/cloths/felt.toml")),
    ("gabardine", include_str!("../../assets/cloths/gabardine.toml")),
    ("jersey", include_str!("../../assets/cloths/jersey.toml")),
    ("linen", include_str!("../../assets/cloths/linen.toml")),
    ("lining", include_str!("../../assets/cloths/lining.toml")),
    ("muslin", include_str!("../../assets/cloths/muslin.toml")),
    ("nonwoven", include_str!("../../assets/cloths/nonwoven.toml")),
    ("rib", include_str!("../../assets/cloths/rib.toml")),
    ("sheer", include_str!("../../assets/cloths/sheer.toml")),
    ("voile", include_str!("../../assets/cloths/voile.toml")),
];

/// The text of a preset.
pub fn preset(name: &str) -> Option<&'static str> {
    PRESETS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}

#[cfg(test)]
mod tests {
    use super::super::{Scene, Source};

    #[test]
    fn presets_have_the_areal_mass_that_their_sources_state() {
        for (name, stated) in [("felt", 814.0), ("nonwoven", 50.0)] {
            let scene = Scene::parse(&Source::find(name).expect("it is a preset")).expect("it is right");
            let mass = scene.sheet().expect("it is a sheet").areal_mass(&scene.fibers).expect("its density is stated");
            assert!((mass / stated - 1.0).abs() < 2e-3, "{name}: {mass} g/m²");
        }
    }
}
