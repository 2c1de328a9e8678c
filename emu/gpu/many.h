// SPDX-License-Identifier: MIT
// `cuboct-gpu many`: runs that come line by line go on at once on one device.
#pragma once

namespace cuboct::gpu {

// A line of standard input is a run: the words of its command line, as an array of TOML or JSON. When it has
// ended a line of standard output tells its number, counted from 1, and its exit code. Ends with its input,
// or where model/base/interrupt.h says so: runs that go on then end after their batch, and later ones are not
// begun. Returns the exit code: 0, 1 interrupted, 2 a line or a word is wrong, or there is no device.
int run_many(int argc, char** argv);

}  // namespace cuboct::gpu
