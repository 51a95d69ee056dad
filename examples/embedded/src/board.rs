//! What the program runs on: start, console, clock, stack. All `unsafe` of the program is here, and
//! all that another board has to replace.
//!
//! A Cortex-M is started by `cortex-m-rt`, a RISC-V by `riscv-rt`; the console is the debugger's
//! (semihosting). With an operating system, there is `std`.
#![allow(unsafe_code)]

#[cfg(all(target_os = "none", target_arch = "arm"))]
use cortex_m_rt as _;
#[cfg(all(target_os = "none", target_arch = "riscv32"))]
use riscv_rt as _;

use core::cell::UnsafeCell;

/// Writes text to the console.
pub fn write(text: &[u8]) {
    #[cfg(target_os = "none")]
    {
        use semihosting::io::{Write, stdout};
        // Without a debugger nobody reads it.
        let _ = stdout().and_then(|mut out| out.write_all(text));
    }
    #[cfg(not(target_os = "none"))]
    {
        extern crate std;
        use std::io::{Write, stdout};
        let _ = stdout().write_all(text);
    }
}

/// Ends the program, with 0 where all went well.
pub fn exit(code: i32) -> ! {
    #[cfg(target_os = "none")]
    semihosting::process::exit(code);
    #[cfg(not(target_os = "none"))]
    {
        extern crate std;
        std::process::exit(code)
    }
}

/// A `static` that is lent to the program once.
#[derive(Debug)]
pub struct Lent<T>(UnsafeCell<T>);

// SAFETY: `lend` gives the only reference to what is inside.
unsafe impl<T> Sync for Lent<T> {}

impl<T> Lent<T> {
    /// Memory with this content.
    pub const fn new(content: T) -> Self {
        Self(UnsafeCell::new(content))
    }

    /// The content.
    ///
    /// # Safety
    /// It is called once.
    #[allow(clippy::mut_from_ref, reason = "once")]
    pub unsafe fn lend(&'static self) -> &'static mut T {
        // SAFETY: the caller calls once.
        unsafe { &mut *self.0.get() }
    }
}

/// The program's start: `program!(function, Memory, initial memory)` calls
/// `function(&'static mut Memory) -> exit code` once.
#[macro_export]
macro_rules! program {
    ($program:path, $memory:ty, $initial:expr) => {
        static MEMORY: $crate::board::Lent<$memory> = $crate::board::Lent::new($initial);

        /// What the start-up code calls when memory is set up and the floating-point unit is on.
        #[cfg(target_os = "none")]
        #[unsafe(export_name = "main")]
        extern "C" fn start() -> ! {
            // SAFETY: the start-up code calls this function once.
            let memory = unsafe { MEMORY.lend() };
            $crate::board::exit($program(memory))
        }

        #[cfg(not(target_os = "none"))]
        fn main() {
            // SAFETY: the only call, in a function that nobody calls again.
            let memory = unsafe { MEMORY.lend() };
            $crate::board::exit($program(memory))
        }

        /// Never linked: nothing panics. With the feature `control` something does, and the image
        /// shows it.
        #[cfg(target_os = "none")]
        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            $crate::board::exit(2)
        }
    };
}

/// What steps of one kind have cost, in clocks of the processor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost {
    steps: u32,
    sum: u64,
    longest: u32,
}

impl Cost {
    /// Takes a step in.
    pub fn add(&mut self, clocks: u32) {
        self.steps += 1;
        self.sum += u64::from(clocks);
        self.longest = self.longest.max(clocks);
    }

    /// Mean of all steps, 0 without a step.
    #[must_use]
    pub fn mean(&self) -> u32 {
        let mean = self.sum.checked_div(u64::from(self.steps)).unwrap_or(0);
        u32::try_from(mean).unwrap_or(u32::MAX)
    }

    /// The longest step.
    #[must_use]
    pub fn longest(&self) -> u32 {
        self.longest
    }
}

/// Counts the processor's clocks by its SysTick timer, which counts down from 2²⁴. Where there is
/// none, all counts are 0.
///
/// The timer need not run at the processor's speed: it is compared with a loop of known length.
/// QEMU with `-icount shift=0` counts an instruction as a clock.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Of the timer, in [`LOOP`](Self::LOOP) clocks.
    ticks: u32,
    started: u32,
}

impl Clock {
    const WRAP: u32 = 0xff_ffff;
    const LOOP: u32 = 1 << 20;

    /// Starts the timer and learns its speed.
    #[must_use]
    pub fn new() -> Self {
        #[cfg(all(target_os = "none", target_arch = "arm"))]
        start_timer();
        let started = Self::now();
        #[cfg(all(target_os = "none", target_arch = "arm"))]
        cortex_m::asm::delay(Self::LOOP);
        Self {
            ticks: Self::ticks_since(started),
            started,
        }
    }

    fn now() -> u32 {
        #[cfg(all(target_os = "none", target_arch = "arm"))]
        return cortex_m::peripheral::SYST::get_current();
        #[cfg(not(all(target_os = "none", target_arch = "arm")))]
        0
    }

    fn ticks_since(start: u32) -> u32 {
        start.wrapping_sub(Self::now()) & Self::WRAP
    }

    /// A step begins.
    pub fn start(&mut self) {
        self.started = Self::now();
    }

    /// Clocks since the step began.
    #[must_use]
    pub fn stop(&self) -> u32 {
        let ticks = u64::from(Self::ticks_since(self.started));
        let clocks = (ticks * u64::from(Self::LOOP)).checked_div(u64::from(self.ticks));
        u32::try_from(clocks.unwrap_or(0)).unwrap_or(u32::MAX)
    }
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

#[cfg(all(target_os = "none", target_arch = "arm"))]
fn start_timer() {
    if let Some(cortex_m::Peripherals {
        SYST: mut timer, ..
    }) = cortex_m::Peripherals::take()
    {
        timer.set_clock_source(cortex_m::peripheral::syst::SystClkSource::Core);
        timer.set_reload(Clock::WRAP);
        timer.clear_current();
        timer.enable_counter();
    }
}

/// How deep the stack has been, bytes: the start-up code has painted it, and what is still painted
/// was never used. `None` where nobody paints.
#[must_use]
pub fn stack_used() -> Option<u32> {
    #[cfg(all(target_os = "none", target_arch = "arm"))]
    {
        unsafe extern "C" {
            static _stack_start: u32;
            static _stack_end: u32;
        }
        let (top, mut place) = (&raw const _stack_start, &raw const _stack_end);
        // SAFETY: the linker script puts the stack, and nothing else, between the two; reading it
        // changes nothing.
        while place < top && unsafe { place.read_volatile() } == cortex_m_rt::STACK_PAINT_VALUE {
            place = place.wrapping_add(1);
        }
        Some((top as usize - place as usize) as u32)
    }
    #[cfg(not(all(target_os = "none", target_arch = "arm")))]
    None
}
