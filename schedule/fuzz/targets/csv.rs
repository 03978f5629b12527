#![no_main]

use topout_schedule_fuzz::{fixtures, survives, write_seeds};

libfuzzer_sys::fuzz_target!(
    init: write_seeds("csv", &[fixtures::CSV, fixtures::LOG]),
    |bytes: &[u8]| survives("plan.csv", bytes)
);
