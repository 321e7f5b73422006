#include "tools/luxrigd/api/command_routes.h"

#include <fmt/format.h>

#include <charconv>
#include <limits>

#include "tools/http/json_body.h"
#include "tools/luxrigd/api/command_limits.h"
#include "tools/luxrigd/api/preview_json.h"
#include "tools/luxrigd/api/question_json.h"

namespace luxrig {
namespace {

constexpr double kIdentifyFor_s = 5;
constexpr const char* kBeingDrawn = "the room is being drawn: ask again in a second";

/// A non-empty list of strings; nullopt if it is anything else.
std::optional<std::vector<std::string>> names_in(const nlohmann::json& body, const char* key) {
  if (!body.is_object() || !body.contains(key) || !body[key].is_array() || body[key].empty()) return std::nullopt;
  std::vector<std::string> names;
  for (const auto& one : body[key]) {
    if (!one.is_string()) return std::nullopt;
    names.push_back(one.get<std::string>());
  }
  return names;
}

std::optional<std::string> id_in(const nlohmann::json& body) {
  if (!body.is_object() || !body.contains("id") || !body["id"].is_string()) return std::nullopt;
  auto id = body["id"].get<std::string>();
  return is_question_id(id) ? std::optional(std::move(id)) : std::nullopt;
}

/// A JSON answer that no cache keeps.
HttpResponse json_answer(std::string text) {
  return {200, "application/json", std::move(text), {{"Cache-Control", "no-store"}}};
}

HttpResponse dumped_answer(const nlohmann::json& answer) {
  return json_answer(answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
}

HttpResponse fault_answer(const Fault& fault) {
  const bool theirs = fault.cause == Cause::invalid || fault.cause == Cause::refused;
  return http_refusal(theirs ? 400 : 500, fault.detail);
}

/// {"<key>": true, "text": …}, or the fault.
HttpResponse done_answer(const Result<std::string>& done, const char* key) {
  if (!done) return fault_answer(done.error());
  return dumped_answer({{key, true}, {"text", *done}});
}
HttpResponse checked_answer(const Checked<std::string>& done, const char* key) {
  if (done) return done_answer(*done, key);
  std::string text;
  for (const Problem& problem : done.error()) text += (text.empty() ? "" : "\n") + problem.text();
  return http_refusal(400, text);
}

/// A key that is there, but is no number in this range.
bool wrong_number(const nlohmann::json& body, const char* key, double least, double most) {
  return body.contains(key) && !(body[key].is_number() && body[key] >= least && body[key] <= most);
}
bool wrong_times(const nlohmann::json& body) {
  return wrong_number(body, "for_s", std::numeric_limits<double>::min(), kLongestByHand_s) ||
         wrong_number(body, "fade_s", kShortestFade_s, kLongestFade_s);
}
std::optional<double> seconds_in(const nlohmann::json& body, const char* key) {
  return body.contains(key) ? std::optional(body[key].get<double>()) : std::nullopt;
}

using ByHandHandler = std::function<Result<std::string>(const std::vector<std::string>&, double, const ByHandTimes&)>;
HttpResponse by_hand(const HttpRequest& request, const char* names_key, const char* value_key,
                     const ByHandHandler& handler) {
  const auto body = json_body(request.body);
  const auto names = names_in(body, names_key);
  if (!names || !body.contains(value_key) || !body[value_key].is_number() || wrong_times(body)) {
    return http_refusal(400, fmt::format("send {{\"{}\": [\"a name\"], \"{}\": a number}}, and with \"for_s\" above 0 "
                                         "for how long, with \"fade_s\" from {} to {} how slowly",
                                         names_key, value_key, kShortestFade_s, kLongestFade_s));
  }
  const ByHandTimes times{seconds_in(body, "for_s"), seconds_in(body, "fade_s"), false};
  return done_answer(handler(*names, body[value_key].get<double>(), times), "held");
}

nlohmann::json job_json(const Job& job) {
  nlohmann::json out = {{"id", job.id}, {"kind", job.kind}, {"state", name_of(job.state)}};
  if (!job.stage.empty()) out["stage"] = job.stage;
  if (!job.doing.empty()) out["doing"] = job.doing;
  if (job.can_be_taken) out["can_be_taken"] = true;
  if (!job.why.empty()) out["why"] = job.why;
  out["has_plan"] = !job.plan_json.empty();
  return out;
}

/// With its plan.
HttpResponse job_answer(const std::optional<Job>& job) {
  if (!job) return http_refusal(404, "there is no such job, or it is so old that it was forgotten");
  nlohmann::json out = job_json(*job);
  if (!job->plan_json.empty()) {
    auto plan = nlohmann::json::parse(job->plan_json, nullptr, false);
    if (!plan.is_object()) return http_refusal(404, "the plan of this job is damaged on disk");
    out["plan"] = std::move(plan);
  }
  return dumped_answer(out);
}

}  // namespace

namespace answer_to {

HttpResponse session(Handlers handlers, Request request) { return handlers.session(request); }
HttpResponse login(Handlers handlers, Request request) { return handlers.login(request); }
HttpResponse logout(Handlers handlers, Request request) { return handlers.logout(request); }

HttpResponse change_log(Handlers handlers, Request) { return json_answer(handlers.change_log()); }

HttpResponse new_address(Handlers handlers, Request) {
  return dumped_answer({{"address", handlers.one_time_address()}});
}

HttpResponse status(Handlers handlers, Request request) {
  const auto since = request.parameter("since");
  return json_answer(since ? handlers.changes(*since) : handlers.status());
}

HttpResponse events(Handlers handlers, Request) {
  return {200, "text/event-stream", "event: status\ndata: " + handlers.status() + "\n\n"};
}

HttpResponse universes(Handlers handlers, Request) { return json_answer(handlers.universes()); }

HttpResponse hand_back(Handlers handlers, Request) {
  handlers.hand_back();
  return dumped_answer({{"handed_back", true}});
}

HttpResponse apply(Handlers handlers, Request request) {
  std::optional<double> fade_s;
  if (const auto text = request.parameter("fade_s")) {
    double value = 0;
    const auto [end, error] = std::from_chars(text->data(), text->data() + text->size(), value);
    if (error != std::errc() || end != text->data() + text->size() ||
        !(value >= kShortestFade_s && value <= kLongestFade_s))
      return http_refusal(400,
                          fmt::format("fade_s is a number of seconds, from {} to {}", kShortestFade_s, kLongestFade_s));
    fade_s = value;
  }
  return checked_answer(handlers.apply(request.body, fade_s), "applied");
}

HttpResponse plan(Handlers handlers, Request) {
  std::string plan = handlers.plan();
  if (plan.empty()) return http_refusal(404, "no plan is in force yet");
  return json_answer(std::move(plan));
}

HttpResponse goal(Handlers handlers, Request request) { return by_hand(request, "points", "goal_lux", handlers.goal); }

HttpResponse reload(Handlers handlers, Request) { return checked_answer(handlers.reload(), "reloaded"); }

HttpResponse level(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  if (!body.is_object() || !body.contains("levels")) return by_hand(request, "fixtures", "level", handlers.level);
  std::vector<std::pair<std::string, double>> levels;
  bool good = (!body.contains("measuring") || body["measuring"].is_boolean()) && body["levels"].is_object() &&
              !body["levels"].empty() && !wrong_times(body) && !body.contains("fixtures") && !body.contains("level");
  if (good)
    for (const auto& [name, value] : body["levels"].items()) {
      good = good && value.is_number();
      if (value.is_number()) levels.emplace_back(name, value.get<double>());
    }
  if (!good)
    return http_refusal(400,
                        "send {\"levels\": {\"a name\": 0.5}} without \"fixtures\" and \"level\"; \"for_s\" and "
                        "\"fade_s\" as with these");
  const ByHandTimes times{seconds_in(body, "for_s"), seconds_in(body, "fade_s"), body.value("measuring", false)};
  return done_answer(handlers.levels(levels, times), "held");
}

HttpResponse blackout(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  if (!body.is_object() || !body.contains("on") || !body["on"].is_boolean())
    return http_refusal(400, "send {\"on\": true} or {\"on\": false}");
  const bool on = body["on"].get<bool>();
  if (const auto done = handlers.blackout(on); !done) return fault_answer(done.error());
  return dumped_answer({{"blackout", on}});
}

HttpResponse identify(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  if (!body.is_object() || !body.contains("fixture") || !body["fixture"].is_string() ||
      (body.contains("seconds") && !body["seconds"].is_number()))
    return http_refusal(400, "send {\"fixture\": \"its name\", \"seconds\": 5}");
  const double seconds = body.value("seconds", kIdentifyFor_s);
  if (!(seconds > 0 && seconds <= kIdentifyAtMost_s))
    return http_refusal(400, fmt::format("seconds must be above 0 and at most {:g}", kIdentifyAtMost_s));
  if (const auto done = handlers.identify(body["fixture"].get<std::string>(), seconds); !done)
    return http_refusal(400, done.error().detail);
  return dumped_answer({{"seconds", seconds}});
}

HttpResponse aim(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  const auto is_number = [&](const char* key) { return body.contains(key) && body[key].is_number(); };
  if (!body.is_object() || !body.contains("fixture") || !body["fixture"].is_string() || !is_number("pan_deg") ||
      !is_number("tilt_deg") || !is_number("level") || !is_number("for_s"))
    return http_refusal(
        400, "send {\"fixture\": \"a head's name\", \"pan_deg\": 0, \"tilt_deg\": 45, \"level\": 0.5, \"for_s\": 10}");
  const double seconds = body["for_s"].get<double>();
  if (!(seconds > 0 && seconds <= kIdentifyAtMost_s))
    return http_refusal(400, fmt::format("for_s must be above 0 and at most {:g}", kIdentifyAtMost_s));
  const Joints joints{rad_from_deg(body["pan_deg"].get<double>()), rad_from_deg(body["tilt_deg"].get<double>()), 0};
  if (const auto done = handlers.aim(body["fixture"].get<std::string>(), joints, body["level"].get<double>(), seconds);
      !done)
    return http_refusal(400, done.error().detail);
  return dumped_answer({{"for_s", seconds}});
}

HttpResponse preview(Handlers handlers, Request request) {
  const auto question = preview_question_of(request.body);
  if (!question) return http_refusal(400, question.error().detail);
  auto light = handlers.preview(*question, request.sender.credential + "/" + question->client);
  if (light) return json_answer(std::move(*light));
  const Cause cause = light.error().cause;
  return http_refusal(cause == Cause::cancelled ? 409 : cause == Cause::timeout ? 503 : 400, light.error().detail);
}

HttpResponse park(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  std::vector<std::string> fixtures;
  bool good = body.is_object() && (!body.contains("fixtures") || body["fixtures"].is_array());
  if (good && body.contains("fixtures")) {
    for (const auto& one : body["fixtures"]) {
      good = good && one.is_string();
      if (one.is_string()) fixtures.push_back(one.get<std::string>());
    }
  }
  if (!good) return http_refusal(400, "send {\"fixtures\": [\"a head's name\"]}, or {} for all");
  if (const auto done = handlers.park(fixtures); !done) return fault_answer(done.error());
  return dumped_answer({{"parked", true}});
}

HttpResponse release(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  const auto names = names_in(body, "names");
  bool good = body.is_object() && (!body.contains("all") || body["all"].is_boolean());
  // "all" must be explicit: a missing list releases nothing.
  good = good && (body.value("all", false) ? !body.contains("names") : names.has_value());
  if (!good) return http_refusal(400, "send {\"names\": [\"a fixture or point\"]} or {\"all\": true}");
  if (wrong_number(body, "fade_s", kShortestFade_s, kLongestFade_s))
    return http_refusal(400, fmt::format("\"fade_s\" goes from {} to {}", kShortestFade_s, kLongestFade_s));
  return done_answer(handlers.release(names.value_or(std::vector<std::string>{}), seconds_in(body, "fade_s")),
                     "released");
}

HttpResponse bypass(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  const auto names = names_in(body, "names");
  if (!names || !body.contains("on") || !body["on"].is_boolean())
    return http_refusal(400, "send {\"names\": [\"a fixture or luxmeter\"], \"on\": true} or false");
  return done_answer(handlers.bypass(*names, body["on"].get<bool>()), "done");
}

HttpResponse question(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  if (const auto id = id_in(body); id && body.contains("withdrawn") && body["withdrawn"] == true) {
    handlers.withdraw_question(*id);
    return dumped_answer({{"withdrawn", true}});
  }
  if (body.contains("withdrawn") && !body["withdrawn"].is_boolean())
    return http_refusal(400, "\"withdrawn\" has to be true or false");
  const auto question = question_from_json(body);
  if (!question) return http_refusal(400, question.error().detail);
  const double seconds = body.contains("for_s") && body["for_s"].is_number() ? body["for_s"].get<double>() : 0;
  if (!(seconds > 0 && seconds <= kLongestAsked_s))
    return http_refusal(400, fmt::format("\"for_s\" must be above 0 and at most {:g}", kLongestAsked_s));
  nlohmann::json said = {{"asked", true}};
  if (const auto answer = handlers.question(*question, seconds)) said["answer"] = to_json(*answer);
  return dumped_answer(said);
}

HttpResponse answer(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  const auto id = id_in(body);
  if (!id) return http_refusal(400, "send the \"id\" of the question that the status has");
  const auto answer = answer_from_json(body);
  if (!answer) return http_refusal(400, answer.error().detail);
  if (const auto done = handlers.answer(*id, *answer); !done) return http_refusal(409, done.error().detail);
  return dumped_answer({{"taken", true}});
}

HttpResponse rig(Handlers handlers, Request request) {
  const auto rig = handlers.rig();
  return rig ? answer_with(*rig, request) : http_refusal(503, kBeingDrawn);
}

HttpResponse scene(Handlers handlers, Request request) { return handlers.scene(request); }

HttpResponse start_job(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  if (!body.is_object() || !body.contains("kind") || body["kind"] != "solve")
    return http_refusal(400, "send {\"kind\": \"solve\"}");
  const auto id = handlers.start_job("solve");
  if (!id) return http_refusal(409, id.error().detail);
  return dumped_answer({{"id", *id}});
}

HttpResponse jobs(Handlers handlers, Request) {
  nlohmann::json all = nlohmann::json::array();
  for (const Job& job : handlers.jobs()) all.push_back(job_json(job));
  return dumped_answer(all);
}

HttpResponse job(Handlers handlers, Request request) {
  return job_answer(handlers.job(std::string(last_part(request.path))));
}

HttpResponse cancel_job(Handlers handlers, Request request) {
  return job_answer(handlers.cancel_job(std::string(last_part(request.path))));
}

HttpResponse room(Handlers handlers, Request) {
  std::string room = handlers.room_json();
  if (room.empty()) return http_refusal(503, kBeingDrawn);
  return json_answer(std::move(room));
}

HttpResponse room_png(Handlers handlers, Request) {
  std::string png = handlers.room_png();
  if (png.empty()) return http_refusal(404, "this rig has no scene to draw");
  return {200, "image/png", std::move(png)};
}

}  // namespace answer_to

}  // namespace luxrig
