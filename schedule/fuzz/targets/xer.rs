#![no_main]

use topout_schedule_fuzz::{fixtures, survives, write_seeds};

libfuzzer_sys::fuzz_target!(
    init: write_seeds("xer", &[fixtures::XER]),
    |bytes: &[u8]| survives("plan.xer", bytes)
);
