#pragma once
/// POST /api/preview: what the light would be if fixtures had other levels or looked elsewhere.

#include <string>
#include <vector>

#include "tools/luxrigd/api/schema.h"
#include "tools/luxrigd/light_preview.h"

namespace luxrig {

inline constexpr std::size_t kMaxChanges = 64;

struct PreviewQuestion {
  std::vector<WantedChange> changes;
  bool reflections = false;
  std::string client;  ///< its own name for itself, as several may share a credential; may be empty
};

/// Refused with a sentence for a person.
[[nodiscard]] Result<PreviewQuestion> preview_question_of(const std::string& body);
[[nodiscard]] std::string preview_text(const Rig& rig, const PreviewedLight& light);

[[nodiscard]] schema::Schema preview_body();
[[nodiscard]] schema::Schema preview_answer();

}  // namespace luxrig
