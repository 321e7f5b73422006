#pragma once
/// Problems of a file as text, for the messages of tests.

#include <string>
#include <vector>

#include "core/result.h"

namespace luxrig::test {

/// A line each.
inline std::string listed(const std::vector<Problem>& problems) {
  std::string lines;
  for (const Problem& problem : problems) lines += problem.text() + "\n";
  return lines;
}

}  // namespace luxrig::test
