//! Maps and terrain in files.

use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;
use urts_mc::mission::world::{
    GreyImage, MapThresholds, OccupancyMap, Unknown, WorldError, classes,
};

/// A folder with a map of 3 columns and 2 rows: top row black, grey, white; bottom row white, white, black.
fn folder() -> TempDir {
    let folder = tempfile::tempdir().unwrap();
    let pixels = [0, 150, 255, 255, 255, 0];
    let pgm = [b"P5\n# by hand\n3 2\n255\n".as_slice(), &pixels].concat();
    fs::write(folder.path().join("map.pgm"), pgm).unwrap();
    folder
}

fn write(folder: &TempDir, yaml: &str) -> PathBuf {
    let path = folder.path().join("map.yaml");
    fs::write(&path, yaml).unwrap();
    path
}

const USUAL: &str = "image: map.pgm\nresolution: 0.5\norigin: [-1.0, 2.0, 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

fn read(yaml: &str, unknown: Unknown) -> Result<OccupancyMap, WorldError> {
    let folder = folder();
    OccupancyMap::read(&write(&folder, yaml), unknown)
}

fn refusal(yaml: &str) -> String {
    read(yaml, Unknown::Occupied).unwrap_err().to_string()
}

#[test]
fn a_map_of_a_map_server_is_read_with_its_lowest_row_first() {
    let map = read(USUAL, Unknown::Occupied).unwrap();
    // Grey 150 is p = 0.41: neither occupied nor free.
    assert_eq!(map.occupied, [false, false, true, true, true, false]);
    let area = map.raster.area();
    assert_eq!((area.lower_m, area.upper_m), ([-1.0, 2.0], [0.5, 3.0]));
    let map = read(USUAL, Unknown::Free).unwrap();
    assert_eq!(map.occupied, [false, false, true, true, false, false]);
}

#[test]
fn a_negated_map_is_the_other_way_round() {
    for negate in ["negate: 1", "negate: true"] {
        let map = read(&USUAL.replace("negate: 0", negate), Unknown::Free).unwrap();
        assert_eq!(map.occupied, [true, true, false, false, false, true]);
    }
}

#[test]
fn thresholds_and_mode_have_the_usual_values_where_they_are_not_given() {
    let short = "image: map.pgm\nresolution: 0.5\norigin: [-1.0, 2.0]\n";
    let usual = read(USUAL, Unknown::Occupied).unwrap();
    assert_eq!(read(short, Unknown::Occupied).unwrap(), usual);
    let trinary = format!("{short}mode: trinary\nsomething_else: 3\n");
    assert_eq!(read(&trinary, Unknown::Occupied).unwrap(), usual);
}

#[test]
fn a_png_is_the_mean_of_its_colours_whatever_its_opacity() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("map.png");
    let pixels = [
        [30, 60, 90, 255],
        [0, 0, 0, 0],
        [255, 255, 255, 10],
        [3, 3, 3, 255],
    ];
    let image = image::RgbaImage::from_raw(2, 2, pixels.concat()).unwrap();
    image.save(&path).unwrap();
    let image = GreyImage::read(&path).unwrap();
    assert_eq!(image.grey(), [255.0, 3.0, 60.0, 0.0]);
}

#[test]
fn terrain_is_the_class_whose_value_a_pixel_has() {
    let folder = folder();
    let image = GreyImage::read(&folder.path().join("map.pgm")).unwrap();
    let listed = |values: &[(&str, u8)]| -> Vec<(String, u8)> {
        values
            .iter()
            .map(|&(name, value)| (name.into(), value))
            .collect()
    };
    let all = listed(&[("floor", 255), ("road", 150), ("rubble", 0)]);
    assert_eq!(classes(&image, &all).unwrap(), [0, 0, 2, 2, 1, 0]);
    let error = classes(&image, &listed(&[("floor", 255), ("rubble", 0)])).unwrap_err();
    let message = error.to_string();
    for part in [
        "map.pgm",
        "column 1, row 0 from the top",
        "150",
        "floor = 255, rubble = 0",
    ] {
        assert!(message.contains(part), "{message}");
    }
}

#[test]
fn maps_that_cannot_be_used_are_refused_with_file_key_value_and_remedy() {
    for (change, parts) in [
        (
            ("mode", "mode: scale"),
            vec!["map.yaml", "mode = scale", "trinary"],
        ),
        (
            ("origin", "origin: [0, 0, 0.1]"),
            vec!["map.yaml", "origin = [0.0, 0.0, 0.1]", "yaw"],
        ),
        (("origin", "origin: [0]"), vec!["map.yaml", "origin"]),
        (
            ("free", "free_thresh: 0.7"),
            vec!["map.yaml", "free_thresh = 0.7", "occupied_thresh = 0.65"],
        ),
        (
            ("free", "free_thresh: -0.1"),
            vec!["map.yaml", "free_thresh = -0.1"],
        ),
        (
            ("occ", "occupied_thresh: 1.1"),
            vec!["map.yaml", "occupied_thresh = 1.1"],
        ),
        (
            ("res", "resolution: 0"),
            vec!["map.yaml", "resolution_m = 0", "positive"],
        ),
        (
            ("res", "resolution: wide"),
            vec!["map.yaml", "image, resolution and origin"],
        ),
        (("res", ""), vec!["map.yaml", "resolution"]),
        (
            ("image", "image: none.pgm"),
            vec!["none.pgm", "cannot be read"],
        ),
        (("image", "image: map.yaml"), vec!["map.yaml", "no image"]),
    ] {
        let kept = USUAL.lines().filter(|line| !line.starts_with(change.0));
        let yaml = kept.chain([change.1]).collect::<Vec<_>>().join("\n");
        let message = refusal(&yaml);
        for part in parts {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
    let missing = OccupancyMap::read(Path::new("/nowhere/map.yaml"), Unknown::Free).unwrap_err();
    assert!(matches!(missing, WorldError::Read { .. }));
}

#[test]
fn an_image_of_too_many_or_too_few_cells_is_refused_by_its_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("large.pgm");
    for (size, part) in [("5000 4000", "16000000"), ("1 7", "at least 2")] {
        // The size is refused before the pixels are read: there are none.
        fs::write(&path, format!("P5\n{size}\n255\n")).unwrap();
        let message = GreyImage::read(&path).unwrap_err().to_string();
        assert!(
            message.contains("large.pgm") && message.contains(part),
            "{message}"
        );
    }
}

#[test]
fn an_image_without_a_description_takes_thresholds_from_the_campaign() {
    let folder = folder();
    let image = GreyImage::read(&folder.path().join("map.pgm")).unwrap();
    let raster = image.raster(0.25, [0.0; 2]).unwrap();
    let thresholds = MapThresholds::usual(Unknown::Occupied);
    let map = OccupancyMap::of_image(&image, raster, &thresholds).unwrap();
    assert_eq!(map.occupied, [false, false, true, true, true, false]);
}
