//! What docs/laws.md says to write into a scene.

use coapt::scene::{ChordLaw, Tissue};

const PAGE: &str = include_str!("../../../../../docs/laws.md");

/// Every block of the page is a law of the layout, and no tissue law is left out. A key that is renamed fails here.
#[test]
fn blocks_of_the_laws_page_are_laws() {
    let blocks: Vec<toml::Value> = PAGE
        .split("```toml\n")
        .skip(1)
        .filter_map(|rest| rest.split("```").next())
        .map(|block| toml::from_str(block).unwrap())
        .collect();
    let part = |block: &toml::Value, path: [&str; 2]| block.get(path[0])?.get(path[1]).cloned();
    let laws: Vec<&str> = blocks
        .iter()
        .filter_map(|block| part(block, ["leaflets", "tissue"]))
        .map(|tissue| tissue.try_into::<Tissue>().unwrap().law_name())
        .collect();
    let all = [
        "bilinear-springs",
        "anisotropic-springs",
        "st-venant-kirchhoff",
        "exponential",
        "may-newman",
    ];
    assert_eq!(laws, all);
    let chordae: Vec<ChordLaw> = blocks
        .iter()
        .filter_map(|block| part(block, ["chordae", "law"]))
        .map(|law| law.try_into().unwrap())
        .collect();
    assert_eq!(laws.len() + chordae.len(), blocks.len());
}
