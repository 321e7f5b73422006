#pragma once
/// LUXRIG_CHECK(condition, "text", values…): catches a caller's bug. Prints the values and aborts. On in every build,
/// since no check is in an inner loop.

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

#define LUXRIG_CHECK(condition, ...)                                                                             \
  do {                                                                                                           \
    if (!(condition)) {                                                                                          \
      std::fputs(                                                                                                \
          fmt::format("{}:{}: check failed: {}: {}\n", __FILE__, __LINE__, #condition, fmt::format(__VA_ARGS__)) \
              .c_str(),                                                                                          \
          stderr);                                                                                               \
      std::abort();                                                                                              \
    }                                                                                                            \
  } while (false)
