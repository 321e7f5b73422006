#pragma once
/// A state to save, and the content of a folder of states.

#include <filesystem>
#include <set>
#include <string>

#include "tools/luxrigd/state/journal.h"

namespace luxrig::testing {

/// Larger than any buffer; half of it is not valid JSON.
inline JournalState state_with(const char* plan) {
  JournalState state{std::string(plan) + std::string(100'000, '.'), false, {"yoke"}};
  state.by_hand = {{false, plan, 0.5, 1.75e9, std::nullopt}};
  return state;
}

inline std::set<std::string> files_in(const std::filesystem::path& folder) {
  std::set<std::string> names;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error))
    names.insert(entry.path().filename().string());
  return names;
}

}  // namespace luxrig::testing
