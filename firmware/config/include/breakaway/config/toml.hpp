// toml++ without its assertions. With NDEBUG it turns them into promises to the compiler, and version 3.3 breaks one on
// a table header like `[[[` (fixed upstream in 2026). Without them it reports the error that it has for such a text.
#pragma once

#pragma push_macro("NDEBUG")
#undef NDEBUG
#define TOML_ASSERT(condition) static_cast<void>(0)
#include <toml++/toml.h>
#pragma pop_macro("NDEBUG")
