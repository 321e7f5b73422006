// Requests about goals that are painted on surfaces.
#include <fmt/format.h>

#include <cmath>

#include "core/goals/painting_file.h"
#include "core/text/plain_text.h"
#include "tools/http/json_body.h"
#include "tools/http/percent.h"
#include "tools/luxrigd/api/command_limits.h"
#include "tools/luxrigd/api/command_routes.h"
#include "tools/luxrigd/painted_goals.h"

namespace luxrig {
namespace {

constexpr std::size_t kToldProblems = 5;
constexpr std::size_t kMaxPatchBytes = 64u << 20;

using OrderedJson = nlohmann::ordered_json;

std::string quoted_version(const std::string& version) { return "\"" + version + "\""; }

HttpResponse uncached_json(const OrderedJson& json, int status = 200) {
  return {status,
          "application/json",
          json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
          {{"Cache-Control", "no-store"}}};
}

/// The document has its strokes' text as the file has it.
OrderedJson json_of(const std::string& name, const PaintingDocument& document) {
  OrderedJson out = {{"name", name}, {"version", document.version}, {"saved", document.saved}};
  out.update(OrderedJson::parse(painting_to_json(document.strokes)));
  return out;
}

HttpResponse refusal_answer(const PaintingRefusal& refusal, const std::string& name = {}) {
  using Why = PaintingRefusal::Why;
  if (refusal.why == Why::stale && refusal.present) {
    OrderedJson out = json_of(name, *refusal.present);
    out["error"] = refusal.text;
    HttpResponse stale = uncached_json(out, 412);
    stale.headers.emplace_back("ETag", quoted_version(refusal.present->version));
    return stale;
  }
  constexpr int kStatus[] = {404, 503, 412, 400, 409, 500};
  return http_refusal(kStatus[static_cast<std::size_t>(refusal.why)], refusal.text);
}

HttpResponse no_such_goal() { return http_refusal(404, "the rig has no such surface goal"); }

/// What If-Match says: none, any ("*"), or a version; weak tags match nothing.
std::optional<std::string> version_in(const HttpRequest& request) {
  const auto tag = request.header("if-match");
  if (!tag || *tag == "*") return std::nullopt;
  const bool strong = tag->size() >= 2 && tag->front() == '"' && tag->back() == '"';
  return std::string(strong ? tag->substr(1, tag->size() - 2) : "none");
}

}  // namespace

namespace answer_to {

HttpResponse surface_goals(Handlers handlers, Request) {
  OrderedJson all = OrderedJson::array();
  if (!handlers.painting) return uncached_json(all);
  for (const PaintedGoals::Listed& one : handlers.painting->all()) {
    OrderedJson goal = {
        {"name", one.goal.name},       {"version", one.painting.version}, {"strokes", one.painting.strokes.size()},
        {"saved", one.painting.saved}, {"in_force", one.in_force},        {"patch_m", one.goal.patch_m}};
    if (one.goal.max_lx) goal["max_lux"] = *one.goal.max_lx;
    if (!one.trouble.empty()) goal["trouble"] = one.trouble;
    all.push_back(std::move(goal));
  }
  return uncached_json(all);
}

HttpResponse add_surface_goal(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  const bool has_name = body.is_object() && body.contains("name") && body["name"].is_string();
  const bool has_limit = has_name && body.contains("max_lux");
  if (!has_name || (has_limit && !(body["max_lux"].is_number() && body["max_lux"] >= 0 && body["max_lux"] <= 1e7)))
    return http_refusal(400, "send {\"name\": \"what it is called\"}, and with \"max_lux\" the most that it may get");
  const auto name = body["name"].get<std::string>();
  if (!is_plain_text(name) || name.empty() || length_in_characters(name) > kLongestName)
    return http_refusal(400, fmt::format("a name has 1 to {} characters, on one line", kLongestName));
  if (!handlers.painting) return http_refusal(409, "this daemon has no rig to paint");
  const auto max_lx = has_limit ? std::optional(body["max_lux"].get<double>()) : std::nullopt;
  if (const auto added = handlers.painting->add(name, max_lx); !added) return refusal_answer(added.error());
  return uncached_json({{"added", true}});
}

HttpResponse surface_goal(Handlers handlers, Request request) {
  const auto name = percent_decoded(last_part(request.path), false);
  if (!name || !handlers.painting) return no_such_goal();
  const auto document = handlers.painting->document(*name);
  if (!document) return refusal_answer(document.error());
  HttpResponse response = uncached_json(json_of(*name, *document));
  response.headers.emplace_back("ETag", quoted_version(document->version));
  return response;
}

HttpResponse put_surface_goal(Handlers handlers, Request request) {
  const auto name = percent_decoded(last_part(request.path), false);
  const auto strokes = painting_from_json(request.body, "painting");
  if (!strokes) {
    std::string text;
    for (std::size_t i = 0; i < std::min(strokes.error().size(), kToldProblems); ++i)
      text += (text.empty() ? "" : "\n") + strokes.error()[i].text();
    return http_refusal(400, text);
  }
  for (const Stroke& stroke : *strokes)
    for (const SurfacePlace& place : stroke.path)
      if (!(std::max(place.position_world_m.cwiseAbs().maxCoeff(), place.normal_world.cwiseAbs().maxCoeff()) <=
            kFarthest_m))
        return http_refusal(400, fmt::format("places are at most {:g} m from the world's zero", kFarthest_m));
  if (!name || !handlers.painting) return no_such_goal();
  const auto change = handlers.painting->put(*name, *strokes, version_in(request));
  if (!change) return refusal_answer(change.error(), *name);
  OrderedJson out = {{"version", change->version},
                     {"strokes", change->strokes},
                     {"patches", change->patches},
                     {"lux", OrderedJson::array()}};
  for (const float lux : change->lux) out["lux"].push_back(std::isnan(lux) ? OrderedJson() : OrderedJson(lux));
  HttpResponse response = uncached_json(out);
  response.headers.emplace_back("ETag", quoted_version(change->version));
  return response;
}

HttpResponse surface_patches(Handlers handlers, Request request) {
  const auto name = percent_decoded(last_part(request.path), false);
  if (!name || !handlers.painting) return no_such_goal();
  const auto patches = handlers.painting->patches(*name);
  if (!patches) return refusal_answer(patches.error());
  if ((*patches)->body.size() > kMaxPatchBytes)
    return http_refusal(413, "the surfaces have too many patches to show in a browser: give the goal a larger patch_m");
  return answer_with(**patches, request);
}

HttpResponse save_painting(Handlers handlers, Request request) {
  const auto body = json_body(request.body);
  std::vector<std::string> names;
  bool good = body.is_object() && (!body.contains("goals") || body["goals"].is_array());
  if (good && body.contains("goals"))
    for (const auto& one : body["goals"]) {
      good = good && one.is_string();
      if (one.is_string()) names.push_back(one.get<std::string>());
    }
  if (!good) return http_refusal(400, "send {\"goals\": [\"a surface goal\"]}, or {} for all");
  if (!handlers.painting) return no_such_goal();
  const auto saved = handlers.painting->save(names);
  if (!saved) return refusal_answer(saved.error());
  const char* what = *saved == 0 ? "nothing has changed since it was saved"
                                 : "strokes and points are beside the rig file: luxrig reload puts them in force";
  return uncached_json({{"saved", true}, {"text", what}});
}

}  // namespace answer_to

}  // namespace luxrig
