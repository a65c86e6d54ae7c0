//! The functions that the module exports to JavaScript: memory for a request, and the call.

#![expect(unsafe_code, reason = "an exported function needs its name; that two of one name exist is not checked")]

use std::cell::RefCell;

use crate::Playground;

/// The only playground of a module, with its request and response.
#[derive(Default)]
struct Module {
    playground: Playground,
    request: Vec<u8>,
    response: String,
}

thread_local! {
    static MODULE: RefCell<Module> = RefCell::default();
}

/// Makes room for a request of `length` bytes and returns its address.
#[unsafe(no_mangle)]
pub extern "C" fn request(length: usize) -> *mut u8 {
    MODULE.with_borrow_mut(|module| {
        module.request.clear();
        module.request.resize(length, 0);
        module.request.as_mut_ptr()
    })
}

/// Answers the request and returns the address of the response: UTF-8 of `response_length` bytes. The response and the
/// arrays that it names are valid until the next call.
#[unsafe(no_mangle)]
pub extern "C" fn call() -> *const u8 {
    MODULE.with_borrow_mut(|Module { playground, request, response }| {
        *response = playground.call(request);
        response.as_ptr()
    })
}

/// The length of the last response in bytes.
#[unsafe(no_mangle)]
pub extern "C" fn response_length() -> usize {
    MODULE.with_borrow(|module| module.response.len())
}
