#![no_main]

use topout_schedule_fuzz::{fixtures, survives, write_seeds};

libfuzzer_sys::fuzz_target!(
    init: write_seeds("ifc", &[fixtures::IFC]),
    |bytes: &[u8]| survives("plan.ifc", bytes)
);
