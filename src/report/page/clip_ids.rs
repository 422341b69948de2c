//! The names of the frames that drawings are clipped at.

/// What the library of the drawings calls the frames that it clips at, before their number.
const CLIP: &str = "kuva-clip-";

/// A page or picture in which the frames of its drawings are numbered as they come: the library counts those of the
/// whole process, and the same drawing must have the same bytes.
pub(crate) fn renumbered(text: &str) -> String {
    let mut numbers: Vec<&str> = Vec::new();
    let mut pieces = text.split(CLIP);
    let mut out = pieces.next().unwrap_or_default().to_string();
    for piece in pieces {
        let end = piece.find(|letter: char| !letter.is_ascii_digit());
        let (number, rest) = piece.split_at(end.unwrap_or(piece.len()));
        let place = numbers.iter().position(|own| *own == number);
        let place = place.unwrap_or_else(|| {
            numbers.push(number);
            numbers.len() - 1
        });
        out.push_str(&format!("{CLIP}{place}{rest}"));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::renumbered;
    use crate::report::page::plot::{Color, Mark, Plot, Stroke};

    #[test]
    fn the_same_page_has_the_same_bytes_whatever_was_drawn_before() {
        let panel = Plot {
            marks: vec![Mark::Line(
                vec![(0.0, 1.0), (2.0, 3.0)],
                Color::Truth,
                Stroke::Solid,
            )],
            ..Plot::default()
        };
        let page = || format!("<p>{}{}</p>", panel.svg(), panel.svg());
        let (first, second) = (page(), page());
        assert_ne!(first, second);
        let again = renumbered(&first);
        assert_eq!(again, renumbered(&second));
        // The drawings of a page keep frames of their own.
        assert!(again.contains("#kuva-clip-0)") && again.contains("#kuva-clip-1)"));
    }
}
