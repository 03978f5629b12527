//! Calendars as Primavera P6 packs them into one text of nested brackets:
//! `(0||Exceptions()((0||0(d|41155)((0||0(s|08:00|f|12:00)())))))`, that is name, values between bars,
//! and members.

use crate::calendar::seconds_of_day;
use crate::{Calendar, CalendarException, Shift};
use chrono::{Days, NaiveDate};

/// Members within each other; P6 writes five.
const MAX_DEPTH: usize = 16;

/// One bracket.
#[derive(Default)]
struct Node<'a> {
    name: &'a str,
    values: &'a str,
    members: Vec<Node<'a>>,
}

/// Reads working hours and exceptions; `None` for a text of another kind.
pub(super) fn read(text: &str) -> Option<Calendar> {
    let root = Parser { text, at: 0 }.node(0)?;
    let mut calendar = Calendar::default();
    for part in &root.members {
        match part.name {
            "DaysOfWeek" => {
                for day in &part.members {
                    // From Sunday = 1 to Monday = 0.
                    if let Ok(number @ 1..=7) = day.name.parse::<usize>() {
                        calendar.week[(number + 5) % 7] = day.shifts();
                    }
                }
            }
            "Exceptions" => {
                calendar.exceptions.extend(part.members.iter().filter_map(Node::exception));
            }
            _ => {}
        }
    }
    Some(calendar)
}

impl Node<'_> {
    /// The value after a letter.
    fn value(&self, letter: &str) -> Option<&str> {
        let mut values = self.values.split('|');
        while let Some(name) = values.next() {
            let value = values.next()?;
            if name == letter {
                return Some(value);
            }
        }
        None
    }

    fn shifts(&self) -> Vec<Shift> {
        let shift = |node: &Node| {
            let start = seconds_of_day(node.value("s")?)?;
            let end = seconds_of_day(node.value("f")?)?;
            // The day's last second is written as its first.
            Shift::new(start, if end == 0 { 86_400 } else { end })
        };
        let mut shifts: Vec<Shift> = self.members.iter().filter_map(shift).collect();
        shifts.sort_unstable_by_key(|s| s.start());
        shifts
    }

    /// Days are counted from 1899-12-30.
    fn exception(&self) -> Option<CalendarException> {
        let number: u64 = self.value("d")?.trim().parse().ok()?;
        let day = NaiveDate::from_ymd_opt(1899, 12, 30)?.checked_add_days(Days::new(number))?;
        Some(CalendarException { first: day, last: day, shifts: self.shifts() })
    }
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
}

impl<'a> Parser<'a> {
    fn peek(&mut self) -> Option<u8> {
        let rest = &self.text.as_bytes()[self.at..];
        self.at += rest.iter().take_while(|&&b| b.is_ascii_whitespace() || b == 0x7f).count();
        self.text.as_bytes().get(self.at).copied()
    }

    fn take(&mut self, byte: u8) -> Option<()> {
        (self.peek()? == byte).then(|| self.at += 1)
    }

    /// Everything up to a bracket.
    fn word(&mut self) -> &'a str {
        let rest = &self.text[self.at..];
        let word = &rest[..rest.find(['(', ')']).unwrap_or(rest.len())];
        self.at += word.len();
        word
    }

    fn node(&mut self, depth: usize) -> Option<Node<'a>> {
        if depth > MAX_DEPTH {
            return None;
        }
        self.take(b'(')?;
        let name = self.word().trim().strip_prefix("0||")?.trim();
        self.take(b'(')?;
        let values = self.word().trim();
        self.take(b')')?;
        let mut node = Node { name, values, members: Vec::new() };
        self.take(b'(')?;
        while self.peek()? == b'(' {
            node.members.push(self.node(depth + 1)?);
        }
        self.take(b')')?;
        self.take(b')')?;
        Some(node)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn hours_and_exceptions() {
        let text = "(0||CalendarData()(  (0||DaysOfWeek()(    (0||1()())
            (0||2()((0||0(f|17:00|s|13:00)())(0||1(s|8:00|f|12:00)()))) (0||3()((0||0(s|22:00|f|00:00)())))
            )) (0||VIEW(ShowTotal|Y)()) (0||Exceptions()( (0||0(d|41155)())
            (0||1(d|36992)((0||0(s|08:00|f|12:00)())))))))";
        let calendar = read(text).unwrap();
        let texts = |shifts: &[Shift]| shifts.iter().map(Shift::to_string).collect::<Vec<_>>();
        assert_eq!(texts(&calendar.week[0]), ["08:00-12:00", "13:00-17:00"]);
        assert_eq!(texts(&calendar.week[1]), ["22:00-24:00"]);
        assert!(calendar.week[6].is_empty());
        let day = |text: &str| text.parse::<NaiveDate>().unwrap();
        assert_eq!(calendar.exceptions[0].first, day("2012-09-03"));
        assert_eq!(texts(calendar.shifts_on(day("2001-04-11"))), ["08:00-12:00"]);
    }

    #[test]
    fn broken_texts_are_none() {
        let deep = "(0||a()(".repeat(100_000);
        for text in ["", "(", "(0||a", "(0||a()", "(x()())", "(0||a()(()))", &deep] {
            assert!(read(text).is_none(), "{:.20}", text);
        }
    }
}
