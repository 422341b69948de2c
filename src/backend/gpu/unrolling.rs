//! Loops of few iterations, written out. naga puts a counter of its own into every loop, so that none runs for ever.
//! That keeps compilers like NVIDIA's from unrolling them. Written out, every number is the same, since the same
//! operations are done in the same order.

use std::collections::HashMap;

/// Iterations of a loop that is written out, at most: the signals of a campaign and its teams are mostly fewer, and the
/// text of a large team would grow without end.
const MOST: u32 = 16;

/// What the head of a loop begins with.
const LOOP: &str = "for (var ";

/// A shader text without loops whose few iterations its constants tell.
#[must_use]
pub fn unrolled(text: &str) -> String {
    let constants = text.lines().filter_map(|line| {
        let (name, value) = line.strip_prefix("const ")?.split_once(" = ")?;
        Some((name, number(value.strip_suffix(';')?)?))
    });
    let mut out = String::with_capacity(2 * text.len());
    write(text, &constants.collect(), &mut out);
    out
}

/// Adds a text with its loops written out.
fn write(text: &str, constants: &HashMap<&str, u32>, out: &mut String) {
    let mut rest = text;
    while let Some((before, from)) = rest.find(LOOP).map(|at| rest.split_at(at)) {
        out.push_str(before);
        let Some(found) = Loop::of(from, constants) else {
            // A loop over steps, whose number nobody knows yet, or over many agents.
            out.push_str(LOOP);
            rest = &from[LOOP.len()..];
            continue;
        };
        let mut body = String::new();
        write(found.body, constants, &mut body);
        for value in found.values {
            out.push('{');
            substitute(&body, found.counter, value, out);
            out.push_str("}\n");
        }
        rest = found.after;
    }
    out.push_str(rest);
}

/// A loop whose bounds are known.
struct Loop<'a> {
    counter: &'a str,
    values: std::ops::Range<u32>,
    body: &'a str,
    /// What follows it.
    after: &'a str,
}

impl<'a> Loop<'a> {
    /// The loop with which a text begins: `for (var k = FIRST; k < UNTIL; k++) {`, without jumps out of it.
    fn of(text: &'a str, constants: &HashMap<&str, u32>) -> Option<Self> {
        let (head, rest) = text.strip_prefix(LOOP)?.split_once(") {")?;
        let mut parts = head.split("; ");
        let (counter, first) = parts.next()?.split_once(" = ")?;
        let until = parts.next()?.strip_prefix(counter)?.strip_prefix(" < ")?;
        if parts.next()? != format!("{counter}++") || parts.next().is_some() {
            return None;
        }
        let mut depth = 1;
        let end = rest.find(|letter| {
            depth += match letter {
                '{' => 1,
                '}' => -1,
                _ => 0,
            };
            depth == 0
        })?;
        let (body, after) = (&rest[..end], &rest[end + 1..]);
        let jumps = ["break", "continue"].iter().any(|word| body.contains(word));
        let values = sum(first, constants)?..sum(until, constants)?;
        let is_short = values.len() <= MOST as usize;
        (is_short && !jumps).then_some(Self {
            counter,
            values,
            body,
            after,
        })
    }
}

/// The value of a sum of products of constants and numbers.
fn sum(text: &str, constants: &HashMap<&str, u32>) -> Option<u32> {
    let factor = |text: &str| number(text).or_else(|| constants.get(text).copied());
    let product = |text: &str| {
        let mut factors = text.split(" * ").map(factor);
        factors.try_fold(1_u32, |all, own| all.checked_mul(own?))
    };
    let mut terms = text.split(" + ").map(product);
    terms.try_fold(0_u32, |all, own| all.checked_add(own?))
}

/// A number as the texts write them: `12u`.
fn number(text: &str) -> Option<u32> {
    text.strip_suffix('u')?.parse().ok()
}

/// Adds a text with a number in the place of a name.
fn substitute(text: &str, name: &str, value: u32, out: &mut String) {
    let is_letter = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut done = 0;
    for (at, _) in text.match_indices(name) {
        let (before, after) = (
            text[..at].chars().last(),
            text[at + name.len()..].chars().next(),
        );
        // A part of another name, or a field.
        let is_own = !before.is_some_and(|own| is_letter(own) || own == '.')
            && !after.is_some_and(is_letter);
        if is_own {
            out.push_str(&text[done..at]);
            out.push_str(&format!("{value}u"));
            done = at + name.len();
        }
    }
    out.push_str(&text[done..]);
}

#[cfg(test)]
mod tests {
    use super::unrolled;

    #[test]
    fn loops_with_constant_bounds_are_written_out_and_others_are_kept() {
        let text = "const N = 2u;\nconst FIRST = 3u;\n\
                    for (var k = FIRST; k < FIRST + N; k++) {\n\
                    ask += kick[k] * own.k + k_2;\n\
                    for (var j = 0u; j < 2u * N; j++) { if j < k { a[j] = k; } }\n}\n\
                    for (var step = span.first; step < span.until; step++) { go(N); }\n\
                    for (var k = 0u; k < 0u; k++) { never(k); }\nend";
        let body = |k: u32| {
            let inner = |j: u32| format!("{{ if {j}u < {k}u {{ a[{j}u] = {k}u; }} }}\n");
            let inner: String = (0..4).map(inner).collect();
            format!("{{\nask += kick[{k}u] * own.k + k_2;\n{inner}\n}}\n")
        };
        let expected = format!(
            "const N = 2u;\nconst FIRST = 3u;\n{}{}\n\
             for (var step = span.first; step < span.until; step++) {{ go(N); }}\n\nend",
            body(3),
            body(4)
        );
        assert_eq!(unrolled(text), expected);
    }

    #[test]
    fn a_long_loop_and_one_that_is_left_early_are_kept_but_not_what_is_in_them() {
        let text = "for (var k = 0u; k < 3u; k++) { if done { break; } }";
        assert_eq!(unrolled(text), text);
        let long = "for (var k = 0u; k < 17u; k++) { for (var j = 0u; j < 1u; j++) {a[j]} }";
        let expected = "for (var k = 0u; k < 17u; k++) { {a[0u]}\n }";
        assert_eq!(unrolled(long), expected);
    }
}
