//! Board support: start, console, clock, stack.
//!
//! All `unsafe` code of the program is here, and so is everything that must be replaced for another
//! board. What depends on the processor is in the folder `board`. The console is that of the
//! debugger (semihosting). With an operating system, `std` is used.
#![allow(unsafe_code)]

#[cfg_attr(
    all(target_os = "none", target_arch = "arm"),
    path = "board/cortex_m.rs"
)]
#[cfg_attr(
    all(target_os = "none", target_arch = "riscv32"),
    path = "board/riscv.rs"
)]
#[cfg_attr(not(target_os = "none"), path = "board/computer.rs")]
mod processor;

use core::cell::UnsafeCell;

/// Writes text to the console.
pub fn write(text: &[u8]) {
    #[cfg(target_os = "none")]
    {
        use semihosting::io::{Write, stdout};
        // Without a debugger, nobody reads the text.
        let _ = stdout().and_then(|mut out| out.write_all(text));
    }
    #[cfg(not(target_os = "none"))]
    {
        extern crate std;
        use std::io::{Write, stdout};
        let _ = stdout().write_all(text);
    }
}

/// Ends the program, with 0 on success.
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

// SAFETY: `lend` returns the only reference to the content.
unsafe impl<T> Sync for Lent<T> {}

impl<T> Lent<T> {
    /// Creates memory with this content.
    pub const fn new(content: T) -> Self {
        Self(UnsafeCell::new(content))
    }

    /// Returns the content.
    ///
    /// # Safety
    ///
    /// The caller calls it only once.
    #[allow(clippy::mut_from_ref, reason = "once")]
    pub unsafe fn lend(&'static self) -> &'static mut T {
        // SAFETY: the caller calls it only once.
        unsafe { &mut *self.0.get() }
    }
}

/// Start of the program: `program!(function, Memory, initial memory)` calls
/// `function(&'static mut Memory) -> exit code` once.
#[macro_export]
macro_rules! program {
    ($program:path, $memory:ty, $initial:expr) => {
        static MEMORY: $crate::board::Lent<$memory> = $crate::board::Lent::new($initial);

        /// Called by the start-up code after memory and floating-point unit have been initialised.
        #[cfg(target_os = "none")]
        #[unsafe(export_name = "main")]
        extern "C" fn start() -> ! {
            $crate::board::paint_stack();
            // SAFETY: the start-up code calls this function once.
            let memory = unsafe { MEMORY.lend() };
            $crate::board::exit($program(memory))
        }

        #[cfg(not(target_os = "none"))]
        fn main() {
            // SAFETY: this is the only call, in a function that is called once.
            let memory = unsafe { MEMORY.lend() };
            $crate::board::exit($program(memory))
        }

        /// Never linked, because nothing panics. With the feature `control` a panic exists, and the
        /// check of the image must find it.
        #[cfg(target_os = "none")]
        #[panic_handler]
        fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
            $crate::board::exit(2)
        }
    };
}

/// Cost of steps of one kind, in clocks of the processor.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cost {
    steps: u32,
    sum: u64,
    longest: u32,
}

impl Cost {
    /// Adds a step.
    pub fn add(&mut self, clocks: u32) {
        self.steps += 1;
        self.sum += u64::from(clocks);
        self.longest = self.longest.max(clocks);
    }

    /// Mean over all steps, 0 without a step.
    #[must_use]
    pub fn mean(&self) -> u32 {
        let mean = self.sum.checked_div(u64::from(self.steps)).unwrap_or(0);
        u32::try_from(mean).unwrap_or(u32::MAX)
    }

    /// Cost of the longest step.
    #[must_use]
    pub fn longest(&self) -> u32 {
        self.longest
    }
}

/// Counter of the processor's clocks.
///
/// On a Cortex-M it is the SysTick timer, which counts down from 2²⁴ and need not have the
/// frequency of the processor. On a RISC-V it is the register `mcycle`. Without such a counter, all
/// counts are 0. It is calibrated by a loop of known length. QEMU with `-icount shift=0` counts an
/// instruction as a clock.
#[derive(Clone, Copy, Debug)]
pub struct Clock {
    /// Ticks of the counter in [`LOOP`](Self::LOOP) clocks.
    ticks: u32,
    started: u32,
}

impl Clock {
    const WRAP: u32 = 0xff_ffff;
    const LOOP: u32 = 1 << 20;

    /// Starts and calibrates the counter.
    #[must_use]
    pub fn new() -> Self {
        processor::start_counter();
        let started = processor::ticks();
        processor::delay(Self::LOOP);
        Self {
            ticks: Self::ticks_since(started),
            started,
        }
    }

    fn ticks_since(start: u32) -> u32 {
        processor::ticks().wrapping_sub(start) & Self::WRAP
    }

    /// Marks the start of a step.
    pub fn start(&mut self) {
        self.started = processor::ticks();
    }

    /// Returns the clocks since the start of the step.
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

/// Paints the stack below the caller, for [`stack_used`], where the start-up code has not.
pub fn paint_stack() {
    processor::paint_stack();
}

/// Largest depth of the stack, bytes.
///
/// The stack was painted before the program ran, and painted memory was never used. Returns `None`
/// where it is not painted.
#[must_use]
pub fn stack_used() -> Option<u32> {
    let (mut place, top) = processor::stack()?;
    // SAFETY: only the stack is between the two addresses, and reading changes nothing.
    while place < top && unsafe { place.read_volatile() } == processor::PAINT {
        place = place.wrapping_add(1);
    }
    Some((top as usize - place as usize) as u32)
}
