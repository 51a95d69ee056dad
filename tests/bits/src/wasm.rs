//! WebAssembly: an export that runs the battery, and an import that takes the text. `run.mjs` gives
//! it one.

use core::fmt;

#[link(wasm_import_module = "env")]
unsafe extern "C" {
    /// Takes `length` bytes of text at `text`.
    fn print(text: *const u8, length: usize);
}

struct Page;

impl fmt::Write for Page {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        // SAFETY: the page copies the bytes before it returns.
        unsafe { print(text.as_ptr(), text.len()) };
        Ok(())
    }
}

#[unsafe(no_mangle)]
extern "C" fn run() -> bool {
    tumble_bits::battery::write(&mut Page, cfg!(feature = "scenes")).is_ok()
}

#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    core::arch::wasm32::unreachable()
}
