//! How a table is written where nobody said it: which date order the dates themselves prove.

/// What the dates of a table show about their order.
#[derive(Default)]
pub(super) struct DateOrder {
    /// The first date that is not ISO 8601 but could be meant so, and what stands between its parts.
    example: Option<(String, char)>,
    /// A first number above 12 was seen: a day.
    day_first: bool,
    /// A second number above 12 was seen: a day.
    month_first: bool,
}

impl DateOrder {
    /// Takes one date into account.
    pub(super) fn see(&mut self, text: &str) {
        let Some((first, second, separator)) = parts(text) else { return };
        match &self.example {
            None => self.example = Some((text.trim().to_owned(), separator)),
            Some((_, known)) if *known != separator => return,
            Some(_) => {}
        }
        self.day_first |= first > 12;
        self.month_first |= second > 12;
    }

    /// Whether there is a date whose order matters.
    pub(super) fn matters(&self) -> bool {
        self.example.is_some()
    }

    /// The format that the dates prove, the order in words and an example. Points mean the day goes
    /// first wherever they are used; with other signs some day above 12 has to show it.
    pub(super) fn proven(self) -> Option<(String, &'static str, String)> {
        let (example, separator) = self.example?;
        let (order, words) = match (self.day_first, self.month_first, separator) {
            (true, false, _) | (false, false, '.') => (["%d", "%m", "%Y"], "day first"),
            (false, true, '-' | '/') => (["%m", "%d", "%Y"], "month first"),
            _ => return None,
        };
        Some((order.join(&separator.to_string()), words, example))
    }
}

/// The first two numbers of a date with its year at the end and four digits in it, such as
/// `3-2-2015`, and what stands between them; a time of day may follow.
fn parts(text: &str) -> Option<(u32, u32, char)> {
    let date = text.trim().split([' ', 'T']).next()?;
    let separator = date.chars().find(|c| !c.is_ascii_digit()).filter(|c| "-./".contains(*c))?;
    let mut numbers = date.split(separator);
    let mut number = |length: std::ops::RangeInclusive<usize>| -> Option<u32> {
        let part = numbers.next()?;
        let digits = length.contains(&part.len()) && part.bytes().all(|b| b.is_ascii_digit());
        digits.then(|| part.parse().ok())?
    };
    let (first, second) = (number(1..=2)?, number(1..=2)?);
    number(4..=4)?;
    let dates = (1..=31).contains(&first) && (1..=31).contains(&second);
    (dates && numbers.next().is_none()).then_some((first, second, separator))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_is_proven() {
        let of = |texts: &[&str]| {
            let mut order = DateOrder::default();
            texts.iter().for_each(|t| order.see(t));
            order.proven().map(|(format, words, _)| (format, words))
        };
        let is = |format: &str, words| Some((format.to_owned(), words));
        assert_eq!(of(&["2-3-2015", "26-2-2015"]), is("%d-%m-%Y", "day first"));
        assert_eq!(of(&["02/03/2015 08:00", "02/26/2015"]), is("%m/%d/%Y", "month first"));
        assert_eq!(of(&["2.3.2015"]), is("%d.%m.%Y", "day first"));
        assert_eq!(of(&["2-3-2015"]), None);
        assert_eq!(of(&["26/2/2015", "2/26/2015"]), None);
        assert_eq!(of(&["2015-02-26", "26-2-15", "", "soon", "26-2-2015-1", "99-1-2015"]), None);
    }
}
