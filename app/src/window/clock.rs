//! The shown date, and how it runs: a value that knows nothing of windows.

use super::calendar::{Calendar, DAY};
use chrono::Months;
use topout_schedule::{Calendar as WorkCalendar, Time, TimeRange};

/// Speeds that are offered, days a second.
pub const SPEEDS: [u32; 7] = [1, 2, 7, 14, 30, 60, 120];
/// Lengths of a run through the whole project that are offered, seconds.
pub const RUNS: [u32; 5] = [10, 20, 30, 60, 120];

/// How fast time runs while playing.
#[derive(Clone, Copy, PartialEq, Eq, Debug, serde::Serialize, serde::Deserialize)]
pub enum Speed {
    /// Days of the project a second.
    Days(u32),
    /// The whole project takes so many seconds.
    Whole(u32),
}

impl Speed {
    /// As it is written in the window.
    pub fn text(self) -> String {
        match self {
            Self::Days(days) => format!("{days} d/s"),
            Self::Whole(seconds) => format!("all in {seconds} s"),
        }
    }

    /// Seconds of the project a second.
    fn seconds(self, period: TimeRange) -> f64 {
        match self {
            Self::Days(days) => f64::from(days.max(1)) * DAY as f64,
            Self::Whole(seconds) => period.seconds() as f64 / f64::from(seconds.max(1)),
        }
    }
}

/// Whether and which way time runs.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Run {
    /// It stands.
    #[default]
    Still,
    /// Towards the end.
    Forward,
    /// Towards the start.
    Backward,
}

/// How far one step of the user's goes; the sign says which way.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Step {
    /// Hours.
    Hours(i64),
    /// Days, which weeks are made of.
    Days(i64),
    /// Months of the calendar; the 31st becomes the last day of a shorter month.
    Months(i32),
    /// To the next instant at which an activity starts or ends (positive), or the one before.
    Event(i32),
}

/// The shown date, held within a period.
#[derive(Clone, Debug)]
pub struct Clock {
    /// Seconds since 1970-01-01T00:00:00, with the fraction that playing needs.
    seconds: f64,
    period: TimeRange,
    run: Run,
    /// J and L pressed again: so many times as fast.
    shuttle: u32,
    /// How fast it runs.
    pub speed: Speed,
    /// Nights and days off are left out while it runs.
    pub skip_idle: bool,
    looped: Option<TimeRange>,
}

impl Default for Clock {
    fn default() -> Self {
        Self {
            seconds: 0.0,
            period: TimeRange::default(),
            run: Run::Still,
            shuttle: 1,
            speed: Speed::Days(30),
            skip_idle: false,
            looped: None,
        }
    }
}

impl Clock {
    /// The shown date.
    pub fn time(&self) -> Time {
        Time::from_seconds(self.seconds.floor() as i64)
    }

    /// Another period; the date and what is played again and again are held within it.
    pub fn set_period(&mut self, period: TimeRange) {
        self.period = period;
        self.looped = self.looped.and_then(|range| self.held(range));
        self.set(self.seconds);
    }

    /// Which way time runs.
    pub fn run(&self) -> Run {
        self.run
    }

    /// Whether time runs.
    pub fn is_playing(&self) -> bool {
        self.run != Run::Still
    }

    /// The part that is played again and again.
    pub fn looped(&self) -> Option<TimeRange> {
        self.looped
    }

    /// Plays a part again and again; nothing, or less than a minute, plays everything once.
    pub fn set_loop(&mut self, range: Option<TimeRange>) {
        self.looped = range.and_then(|range| self.held(range));
    }

    fn held(&self, range: TimeRange) -> Option<TimeRange> {
        let start = range.start.max(self.period.start);
        let end = range.end.min(self.period.end);
        (start.plus_seconds(60) <= end).then_some(TimeRange { start, end })
    }

    /// What playing goes through.
    fn span(&self) -> TimeRange {
        self.looped.unwrap_or(self.period)
    }

    /// Goes to an instant, held within the period; running goes on.
    pub fn jump(&mut self, time: Time) {
        self.set(time.seconds() as f64);
    }

    fn set(&mut self, seconds: f64) {
        let (start, end) = (self.period.start.seconds() as f64, self.period.end.seconds() as f64);
        self.seconds = seconds.max(start).min(end.max(start));
    }

    /// Stands still.
    pub fn pause(&mut self) {
        (self.run, self.shuttle) = (Run::Still, 1);
    }

    /// Stands still at the start of what is played.
    pub fn stop(&mut self) {
        self.pause();
        self.jump(self.span().start);
    }

    /// Runs one way; where it would be at its end at once, it starts over. Asked again for the way
    /// that it runs already, it runs twice as fast, up to sixteen times, where `faster`.
    pub fn play(&mut self, run: Run, faster: bool) {
        let span = self.span();
        if run == Run::Still || span.seconds() <= 0 {
            return self.pause();
        }
        self.shuttle = if faster && self.run == run { (self.shuttle * 2).min(16) } else { 1 };
        self.run = run;
        let now = self.time();
        match run {
            Run::Forward if now >= span.end || now < span.start => self.jump(span.start),
            Run::Backward if now <= span.start || now > span.end => self.jump(span.end),
            _ => {}
        }
    }

    /// Pauses, or plays forward.
    pub fn toggle(&mut self) {
        self.play(if self.is_playing() { Run::Still } else { Run::Forward }, false);
    }

    /// Steps and stands still. Without an event that way it stays where it is.
    pub fn step(&mut self, step: Step, calendar: &Calendar) {
        self.pause();
        match step {
            Step::Hours(hours) => self.set(self.seconds + (hours * 3600) as f64),
            Step::Days(days) => self.set(self.seconds + (days * DAY) as f64),
            Step::Months(months) => {
                let size = Months::new(months.unsigned_abs());
                let moved = self.time().civil().and_then(|civil| match months < 0 {
                    true => civil.checked_sub_months(size),
                    false => civil.checked_add_months(size),
                });
                self.jump(moved.map_or(self.time(), Time::from_civil));
            }
            Step::Event(way) => {
                let event = calendar.event_beside(self.time(), way > 0);
                self.jump(event.unwrap_or_else(|| self.time()));
            }
        }
    }

    /// The next higher or lower speed of those offered.
    pub fn change_speed(&mut self, faster: bool) {
        let next = |known: &[u32], now: u32, up: bool| match up {
            true => known.iter().copied().find(|s| *s > now),
            false => known.iter().copied().rev().find(|s| *s < now),
        };
        self.speed = match self.speed {
            Speed::Days(days) => Speed::Days(next(&SPEEDS, days, faster).unwrap_or(days)),
            Speed::Whole(time) => Speed::Whole(next(&RUNS, time, !faster).unwrap_or(time)),
        };
    }

    /// How many times as fast as its speed it runs.
    pub fn shuttle(&self) -> u32 {
        self.shuttle
    }

    /// Lets time run on by `seconds` of the user's time. `work`: when somebody works.
    pub fn advance(&mut self, seconds: f64, work: Option<&WorkCalendar>) {
        let way = match self.run {
            Run::Still => return,
            Run::Forward => 1.0,
            Run::Backward => -1.0,
        };
        let rate = self.speed.seconds(self.period) * f64::from(self.shuttle);
        self.set(self.seconds + way * seconds * rate);
        if let Some(work) = work.filter(|_| self.skip_idle) {
            self.skip(work);
        }
        let (span, now) = (self.span(), self.time());
        let over = match self.run {
            Run::Backward => now <= span.start,
            _ => now >= span.end,
        };
        match (over, self.looped) {
            (false, _) => {}
            (true, None) => self.pause(),
            (true, Some(_)) => {
                self.jump(if self.run == Run::Backward { span.end } else { span.start });
            }
        }
    }

    /// Goes on to when somebody works.
    fn skip(&mut self, work: &WorkCalendar) {
        let (now, span) = (self.time(), self.span());
        match self.run {
            Run::Backward => match work.last_work(now) {
                Some(last) if last < now => self.jump(last),
                Some(_) => {}
                None => self.jump(span.start),
            },
            _ => match work.next_work(now) {
                Some(next) if next > now => self.jump(next),
                Some(_) => {}
                None => self.jump(span.end),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use topout_schedule::{Activity, Schedule};

    fn day(day: i64) -> Time {
        Time::from_seconds(day * DAY)
    }

    /// A hundred days.
    fn clock() -> Clock {
        let mut clock = Clock::default();
        clock.set_period(TimeRange { start: day(0), end: day(100) });
        clock
    }

    fn play_for(clock: &mut Clock, seconds: f64) {
        for _ in 0..(seconds * 60.0) as usize {
            clock.advance(1.0 / 60.0, None);
        }
    }

    #[test]
    fn it_runs_both_ways_and_stands_at_the_ends() {
        let mut clock = clock();
        clock.toggle();
        play_for(&mut clock, 1.0);
        assert!((clock.time().seconds() - 30 * DAY).abs() < 10, "{}", clock.time());
        clock.play(Run::Backward, false);
        play_for(&mut clock, 0.5);
        assert!((clock.time().seconds() - 15 * DAY).abs() < 10);
        play_for(&mut clock, 1.0);
        assert_eq!((clock.run(), clock.time()), (Run::Still, day(0)));
        clock.play(Run::Backward, false);
        assert_eq!(clock.time(), day(100), "backward from the start begins at the end");
        clock.toggle();
        clock.toggle();
        assert_eq!(clock.time(), day(0), "forward from the end starts over");
    }

    #[test]
    fn the_same_key_again_is_faster_and_another_speed_takes_the_whole_project() {
        let mut clock = clock();
        for times in [1, 2, 4, 8, 16, 16] {
            clock.play(Run::Forward, true);
            assert_eq!(clock.shuttle(), times);
        }
        clock.play(Run::Backward, true);
        assert_eq!(clock.shuttle(), 1);
        clock.stop();
        assert_eq!((clock.time(), clock.shuttle()), (day(0), 1));
        clock.speed = Speed::Whole(20);
        clock.toggle();
        play_for(&mut clock, 10.0);
        assert!((clock.time().seconds() - 50 * DAY).abs() < 60, "{}", clock.time());
        clock.change_speed(true);
        assert_eq!(clock.speed, Speed::Whole(10));
        clock.change_speed(true);
        assert_eq!(clock.speed, Speed::Whole(10), "the shortest");
    }

    #[test]
    fn a_loop_is_played_again_and_again() {
        let mut clock = clock();
        clock.set_loop(Some(TimeRange { start: day(40), end: day(55) }));
        clock.toggle();
        assert_eq!(clock.time(), day(40), "playing begins in it");
        for _ in 0..600 {
            clock.advance(1.0 / 60.0, None);
            assert!(clock.is_playing() && day(40) <= clock.time() && clock.time() < day(55));
        }
        clock.set_loop(Some(TimeRange { start: day(90), end: day(900) }));
        assert_eq!(clock.looped().unwrap().end, day(100), "held within the period");
        clock.set_loop(Some(TimeRange { start: day(9), end: day(9) }));
        assert_eq!(clock.looped(), None, "too short");
    }

    #[test]
    fn steps_by_hours_months_and_events() {
        let at = |text: &str| Time::parse_iso(text).unwrap();
        let dates = [("2027-01-10", "2027-02-01"), ("2027-01-10T07:00", "2027-03-31")];
        let activity = |(i, (start, end)): (usize, (&str, &str))| Activity {
            id: i.to_string(),
            start: Some(at(start)),
            end: Some(at(end)),
            ..Activity::default()
        };
        let activities = dates.into_iter().enumerate().map(activity).collect();
        let schedule = Schedule::new(String::new(), None, activities, Default::default());
        let calendar = Calendar::new(&schedule);
        let mut clock = Clock::default();
        clock.set_period(schedule.period);
        clock.jump(at("2027-01-31"));
        for (step, expected) in [
            (Step::Months(1), "2027-02-28"),
            (Step::Months(-1), "2027-01-28"),
            (Step::Hours(-3), "2027-01-27T21:00"),
            (Step::Event(1), "2027-02-01"),
            (Step::Event(1), "2027-03-31"),
            (Step::Event(1), "2027-03-31"),
            (Step::Event(-1), "2027-02-01"),
            (Step::Event(-1), "2027-01-10T07:00"),
            (Step::Event(-1), "2027-01-10"),
            (Step::Event(-1), "2027-01-10"),
            (Step::Months(14), "2027-03-31"),
        ] {
            clock.step(step, &calendar);
            assert_eq!(clock.time(), at(expected), "{step:?}");
        }
    }
}
