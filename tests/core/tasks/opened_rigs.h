#pragma once
/// Rigs written as text by tests, opened; their light, and the text of a plan.

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/rig/rig_file.h"
#include "core/tasks/session.h"
#include "tests/folders.h"

namespace luxrig {

inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

/// folder   of the files that the rig names
inline Checked<Session> open_rig(const std::string& text, const std::filesystem::path& folder) {
  auto rig = parse_rig(text, folder / "rig.toml", folder);
  if (!rig) return tl::unexpected(rig.error());
  return session_of(std::move(*rig));
}

inline Session opened_rig(const std::string& text, const std::filesystem::path& folder) {
  auto session = open_rig(text, folder);
  EXPECT_TRUE(session) << session.error()[0].text();
  return std::move(*session);
}

inline TransportMatrix transport_of(const Session& session, const ComputeOptions& options, ModelUsed* used = nullptr) {
  auto transport = compute_transport(session, options, {}, used);
  EXPECT_TRUE(transport) << transport.error().detail;
  return std::move(*transport);
}

/// The text of a plan without its run time.
inline std::string text_of(Plan plan) {
  plan.seconds = 0;
  for (PlannedTask& task : plan.tasks) task.seconds = 0;
  return to_json(plan);
}

}  // namespace luxrig
