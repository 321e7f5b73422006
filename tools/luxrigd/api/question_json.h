#pragma once
/// Questions of a client that measures by hand, and their answers, as JSON: API.md beside this file. The daemon and the
/// client both read and write them here.

#include <nlohmann/json_fwd.hpp>

#include "core/result.h"
#include "tools/luxrigd/hand_question.h"

namespace luxrig {

[[nodiscard]] nlohmann::json to_json(const HandQuestion& question);
/// Refused with a sentence for a person: a type, length or number that is none of a question.
[[nodiscard]] Result<HandQuestion> question_from_json(const nlohmann::json& body);
/// What names a question: 1 to 40 letters, digits, - and _.
[[nodiscard]] bool is_question_id(const std::string& id);

/// {"what":"reading","lux":182.5}; without "lux" if it is no reading.
[[nodiscard]] nlohmann::json to_json(const HandAnswer& answer);
[[nodiscard]] Result<HandAnswer> answer_from_json(const nlohmann::json& body);

}  // namespace luxrig
