//! Numbers as people read them.

/// Six significant digits, without trailing zeros; powers of ten for the very small and large.
pub(crate) fn number(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".into();
    }
    if !value.is_finite() {
        return "not finite".into();
    }
    let text = if (1e-3..1e6).contains(&size) {
        let decimals = (5 - size.log10().floor() as i32).max(0) as usize;
        let text = format!("{value:.decimals$}");
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text }
    } else {
        let text = format!("{value:.4e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        format!("{}e{power}", digits.trim_end_matches('0').trim_end_matches('.'))
    };
    text.replace('-', "−")
}

/// A count with its thousands set apart.
pub(crate) fn count(n: u64) -> String {
    let digits = n.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push('\u{202f}');
        }
        out.push(digit);
    }
    out
}

/// A relative error in per cent, with its sign.
pub(crate) fn percent(error: f64) -> String {
    format!("{:+.2} %", 100.0 * error).replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        let texts = [0.0, 1.0, -0.1231234, 32024.0, 1.5e-7, -2.0e9, f64::NAN].map(number);
        assert_eq!(texts, ["0", "1", "−0.123123", "32024", "1.5e−7", "−2e9", "not finite"]);
        assert_eq!((count(129_285), percent(-0.0112)), ("129\u{202f}285".into(), "−1.12 %".into()));
    }
}
