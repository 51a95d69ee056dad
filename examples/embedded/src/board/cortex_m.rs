//! Start, counter and stack of a Cortex-M. `cortex-m-rt` starts it and paints the stack.

use cortex_m::Peripherals;
use cortex_m::peripheral::SYST;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m_rt::STACK_PAINT_VALUE;

pub(super) use cortex_m::asm::delay;

/// Content of memory of the stack that was never used.
pub(super) const PAINT: u32 = STACK_PAINT_VALUE;

const RELOAD: u32 = 0xff_ffff;

/// Starts the SysTick timer.
pub(super) fn start_counter() {
    if let Some(Peripherals {
        SYST: mut timer, ..
    }) = Peripherals::take()
    {
        timer.set_clock_source(SystClkSource::Core);
        timer.set_reload(RELOAD);
        timer.clear_current();
        timer.enable_counter();
    }
}

/// Ticks since the timer started, modulo 2²⁴.
pub(super) fn ticks() -> u32 {
    RELOAD - SYST::get_current()
}

/// Lowest and highest address of the stack.
pub(super) fn stack() -> Option<(*const u32, *const u32)> {
    // From the linker script.
    unsafe extern "C" {
        static _stack_start: u32;
        static _stack_end: u32;
    }
    Some((&raw const _stack_end, &raw const _stack_start))
}

/// The start-up code has painted the stack.
pub(super) fn paint_stack() {}
