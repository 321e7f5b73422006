#include "tools/luxrig/calibrate/page_question.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <random>
#include <utility>

#include "tools/luxrigd/api/question_json.h"
#include "tools/process/status_fields.h"

namespace luxrig {
namespace {

using nlohmann::json;

/// The terminal is not kept waiting for longer.
constexpr int kPageWait_s = 2;

std::string one_line(const json& body) { return body.dump(-1, ' ', false, json::error_handler_t::replace); }

}  // namespace

PageQuestion::PageQuestion(HttpPeer daemon, double for_s)
    : daemon_(std::move(daemon)), for_s_(for_s), name_(fmt::format("{:08x}", std::random_device{}())) {}

PageQuestion::~PageQuestion() {
  if (number_ > 0)
    (void)http_post_json(daemon_, "/api/question", one_line({{"id", question_.id}, {"withdrawn", true}}), kPageWait_s);
}

void PageQuestion::put(HandQuestion question) {
  question_ = std::move(question);
  question_.id = fmt::format("{}-{}", name_, ++number_);
}

std::optional<HandAnswer> PageQuestion::look() {
  json body = to_json(question_);
  body["for_s"] = for_s_;
  const auto said = http_post_json(daemon_, "/api/question", one_line(body), kPageWait_s);
  // A daemon that is gone ends the asking elsewhere.
  if (!said) return std::nullopt;
  const json told = json::parse(said->body, nullptr, false);
  why_not_ = said->status == 200 ? "" : text_of(told, "error");
  if (said->status != 200 || !told.is_object() || !told.contains("answer")) return std::nullopt;
  const auto answer = answer_from_json(told["answer"]);
  return answer ? std::optional(*answer) : std::nullopt;
}

HandAnswer PageQuestion::settle(const HandAnswer& here) {
  // Put there once more first: the answer may come before the page has asked, or after its time.
  if (const auto first = look()) return *first;
  json body = to_json(here);
  body["id"] = question_.id;
  const auto said = http_post_json(daemon_, "/api/answer", one_line(body), kPageWait_s);
  if (!said || said->status != 409) return here;
  return look().value_or(here);
}

}  // namespace luxrig
