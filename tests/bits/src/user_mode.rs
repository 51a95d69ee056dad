//! AArch64 and RISC-V: a program without a library, which calls Linux for two functions. QEMU's
//! user mode provides them.

use core::arch::{asm, global_asm};
use core::fmt;

// The stack is there; the rest of what a C library would set up is not needed.
#[cfg(target_arch = "aarch64")]
global_asm!(".globl _start", "_start:", "mov x29, #0", "bl start");
#[cfg(target_arch = "riscv32")]
global_asm!(".globl _start", "_start:", "call start");

const WRITE: usize = 64;
const EXIT: usize = 93;

/// One call of the system.
///
/// # Safety
/// The arguments are valid for the call.
unsafe fn call(number: usize, [a, b, c]: [usize; 3]) -> usize {
    let result;
    // SAFETY: the system changes the first argument's register and what the call writes to, nothing
    // else.
    unsafe {
        #[cfg(target_arch = "aarch64")]
        asm!("svc #0", in("x8") number, inout("x0") a => result, in("x1") b, in("x2") c, options(nostack));
        #[cfg(target_arch = "riscv32")]
        asm!("ecall", in("a7") number, inout("a0") a => result, in("a1") b, in("a2") c, options(nostack));
    }
    result
}

/// Standard output.
pub(crate) struct Out;

impl fmt::Write for Out {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        // SAFETY: the bytes are there for the length of the call.
        let written = unsafe { call(WRITE, [1, text.as_ptr() as usize, text.len()]) };
        if written == text.len() {
            Ok(())
        } else {
            Err(fmt::Error)
        }
    }
}

pub(crate) fn exit(code: usize) -> ! {
    loop {
        // SAFETY: ends the program.
        unsafe { call(EXIT, [code, 0, 0]) };
    }
}

#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    crate::main()
}
