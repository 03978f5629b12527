#![no_main]

use topout_schedule_fuzz::{fixtures, survives, write_seed};

libfuzzer_sys::fuzz_target!(
    init: write_seed("csv", fixtures::CSV),
    |bytes: &[u8]| survives("plan.csv", bytes)
);
