//! Shader text as a value: parts joined, errors mapped back to part and line.

use super::layout::{BLOCK, TEXTURE_BITS, UNIFORM_ENTRIES};
use crate::error::{Error, Result};
use crate::goniometer::{MOST_RINGS, OUTCOMES, WEIGHT};
use crate::scene::{MAX_CHANNELS, MAX_KINDS};
use crate::walk::{MOST_REFUSALS, Purpose, ROULETTE_BELOW, ROULETTE_EVERY, STRAIGHT};
use naga::valid::{Capabilities, ModuleInfo, ValidationFlags, Validator};

/// A shader of several parts.
#[derive(Clone, Debug)]
pub struct Shader {
    parts: Vec<(&'static str, String)>,
}

macro_rules! part {
    ($name:literal) => {
        ($name, include_str!(concat!("../../shaders/", $name)).to_owned())
    };
}

impl Shader {
    /// A shader of named parts.
    pub fn new(parts: Vec<(&'static str, String)>) -> Shader {
        Shader { parts }
    }

    /// The kernel.
    pub fn walk() -> Shader {
        Shader::common().with(part!("score.wgsl")).with(part!("first_hit.wgsl")).with(part!("walk.wgsl"))
    }

    /// The functions of the kernel one by one.
    pub fn probe() -> Shader {
        Shader::common().with(part!("probe.wgsl"))
    }

    /// A loop that counts its passes.
    pub fn loops() -> Shader {
        Shader::new(vec![part!("loops.wgsl")])
    }

    fn common() -> Shader {
        Shader::new(vec![
            ("constants", constants()),
            part!("layout.wgsl"),
            part!("rng.wgsl"),
            part!("concentric.wgsl"),
            part!("cells.wgsl"),
            part!("medium.wgsl"),
            part!("march.wgsl"),
            part!("memory.wgsl"),
            part!("carried.wgsl"),
            part!("cylinder.wgsl"),
            part!("goniometer.wgsl"),
        ])
    }

    fn with(mut self, part: (&'static str, String)) -> Shader {
        self.parts.push(part);
        self
    }

    /// The parts, in order.
    pub fn parts(&self) -> &[(&'static str, String)] {
        &self.parts
    }

    /// The joined text.
    pub fn text(&self) -> String {
        self.parts.iter().map(|(_, text)| text.as_str()).collect()
    }

    /// Parse and validate, with no optional capability.
    ///
    /// # Errors
    /// [`Error::Shader`] with part, line and column.
    pub fn check(&self) -> Result<(naga::Module, ModuleInfo)> {
        let text = self.text();
        let module = naga::front::wgsl::parse_str(&text).map_err(|error| {
            let place = error.location(&text).map_or((1, 1), |at| (at.line_number, at.line_position));
            self.error(place, error.message())
        })?;
        let info =
            Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).map_err(|error| {
                let place = error.location(&text).map_or((1, 1), |at| (at.line_number, at.line_position));
                self.error(place, &chain(error.as_inner()))
            })?;
        Ok((module, info))
    }

    /// An error at a line and column of the joined text.
    fn error(&self, (line, column): (u32, u32), message: &str) -> Error {
        let mut line = line as usize;
        let mut place = "";
        for (part, text) in &self.parts {
            place = part;
            let lines = text.lines().count();
            if line <= lines {
                break;
            }
            line -= lines;
        }
        Error::Shader { part: place.into(), line, column: column as usize, message: message.into() }
    }
}

/// An error with its causes.
fn chain(error: &dyn std::error::Error) -> String {
    let causes = std::iter::successors(error.source(), |cause| cause.source());
    causes.fold(error.to_string(), |text, cause| format!("{text}: {cause}"))
}

/// Constants that the host decides.
fn constants() -> String {
    let constant = |(name, value): (&str, u32)| format!("const {name}: u32 = {value}u;\n");
    let numbers = [
        ("UNIFORM_ENTRIES", UNIFORM_ENTRIES),
        ("TEXTURE_BITS", TEXTURE_BITS),
        ("TEXTURE_MASK", (1 << TEXTURE_BITS) - 1),
        ("BLOCK", BLOCK),
        ("PURPOSE_EVENT", Purpose::Event as u32),
        ("PURPOSE_START", Purpose::Start as u32),
        ("PURPOSE_EXIT", Purpose::Exit as u32),
        ("PURPOSE_ROULETTE", Purpose::Roulette as u32),
        ("MAX_KINDS", MAX_KINDS as u32),
        ("MAX_CHANNELS", MAX_CHANNELS as u32),
        ("OUTCOMES", OUTCOMES as u32),
        ("MOST_RINGS", MOST_RINGS as u32),
        ("WEIGHT", WEIGHT as u32),
        ("ROULETTE_EVERY", ROULETTE_EVERY),
        ("MOST_REFUSALS", MOST_REFUSALS),
    ];
    let floats = format!("const ROULETTE_BELOW: f32 = {ROULETTE_BELOW:?};\nconst STRAIGHT: f32 = {STRAIGHT:?};\n");
    numbers.into_iter().map(constant).collect::<String>() + &floats
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_error_names_the_line_of_its_part() {
        let first = ("first.wgsl", "// one\nconst ONE: u32 = 1u;\n".to_owned());
        let second = ("second.wgsl", "fn two() -> u32 {\n    return ONE + mean_pth;\n}\n".to_owned());
        let error = Shader::new(vec![first, second]).check().expect_err("an unknown name is an error");
        assert_eq!(error.to_string(), "shaders/second.wgsl:2:18: no definition in scope for identifier: `mean_pth`");
    }

    #[test]
    fn a_validation_error_names_its_line_too() {
        let first = ("first.wgsl", "// one\n\n".to_owned());
        let second = ("second.wgsl", "@group(0) @binding(0)\nvar<storage> a: array<bool>;\n".to_owned());
        let error = Shader::new(vec![first, second]).check().expect_err("a host-shared bool is an error");
        assert!(error.to_string().starts_with("shaders/second.wgsl:"), "{error}");
    }
}
