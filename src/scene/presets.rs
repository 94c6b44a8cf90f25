//! Cloth files that come with the program.

/// Names and texts of the presets.
pub const PRESETS: [(&str, &str); 2] = [
    ("felt", include_str!("../../assets/cloths/felt.toml")),
    ("nonwoven", include_str!("../../assets/cloths/nonwoven.toml")),
];

/// The text of a preset.
pub fn preset(name: &str) -> Option<&'static str> {
    PRESETS.iter().find(|(known, _)| *known == name).map(|(_, text)| *text)
}
