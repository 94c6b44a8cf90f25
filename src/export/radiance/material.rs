//! A material to paste into a scene of Radiance.

/// The scene description beside an XML file: x of the cloth is the weft, y the warp, up in the scene.
pub fn rad(word: &str, xml: &str, title: &str, open: bool) -> String {
    let why = if open {
        "aBSDF lets light that touches no fiber through in a straight line"
    } else {
        "BSDF with no thickness: all of the light is scattered"
    };
    let material = if open {
        format!("void aBSDF {word}\n5 {xml} 0 1 0 .\n0\n0\n")
    } else {
        format!("void BSDF {word}\n6 0 {xml} 0 1 0 .\n0\n0\n")
    };
    let title: String = title.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    format!(
        "# {title}: {why}.\n# The warp runs along 0 1 0; a surface whose normal is +z shows the front. Keep the XML file in RAYPATH.\n\
         {material}\n# A piece of 1 × 1 to try it on.\n{word} polygon {word}_piece\n0\n0\n12\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
    )
}
