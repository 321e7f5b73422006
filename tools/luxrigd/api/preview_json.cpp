#include "tools/luxrigd/api/preview_json.h"

#include <cmath>

#include "tools/http/json_body.h"
#include "tools/luxrigd/api/command_limits.h"
#include "tools/luxrigd/api/question_json.h"

namespace luxrig {
namespace {

using nlohmann::json;

bool is_number(const json& value, double least, double most) {
  return value.is_number() && value >= least && value <= most;
}

bool read(const json& body, WantedChange& out) {
  if (!body.is_object() || !body.contains("fixture") || !body["fixture"].is_string()) return false;
  out.fixture = body["fixture"].get<std::string>();
  if (body.contains("level")) {
    if (!is_number(body["level"], 0, 1)) return false;
    out.level = body["level"].get<double>();
  }
  if (body.contains("aim")) {
    const json& aim = body["aim"];
    if (!aim.is_array() || aim.size() != 3 || body.contains("pan_deg") || body.contains("tilt_deg")) return false;
    Vec3 at;
    for (int axis = 0; axis < 3; ++axis) {
      const json& one = aim[static_cast<std::size_t>(axis)];
      if (!is_number(one, -kFarthest_m, kFarthest_m)) return false;
      at[axis] = one.get<double>();
    }
    out.aim_world_m = at;
    return true;
  }
  if (body.contains("pan_deg") != body.contains("tilt_deg")) return false;
  if (!body.contains("pan_deg")) return out.level.has_value();
  if (!body["pan_deg"].is_number() || !body["tilt_deg"].is_number()) return false;
  out.joints = Joints{rad_from_deg(body["pan_deg"].get<double>()), rad_from_deg(body["tilt_deg"].get<double>()), 0};
  return true;
}

}  // namespace

Result<PreviewQuestion> preview_question_of(const std::string& text) {
  const json body = json_body(text);
  PreviewQuestion out;
  bool good = body.is_object() && body.contains("fixtures") && body["fixtures"].is_array() &&
              !body["fixtures"].empty() && body["fixtures"].size() <= kMaxChanges &&
              (!body.contains("reflections") || body["reflections"].is_boolean()) &&
              (!body.contains("client") || body["client"].is_string());
  if (good)
    for (const json& one : body["fixtures"]) {
      WantedChange change;
      good = good && read(one, change);
      out.changes.push_back(std::move(change));
    }
  if (!good)
    return refusal(
        "send {\"fixtures\": [{\"fixture\": \"a name\", \"level\": 0.5, \"aim\": [x, y, z]}]}, at most 64, each with a "
        "level, an aim, or pan_deg and tilt_deg in place of the aim");
  out.reflections = body.value("reflections", false);
  out.client = body.value("client", std::string());
  if (!out.client.empty() && !is_question_id(out.client))
    return refusal("\"client\" has 1 to 40 letters, digits, - and _");
  if (out.client.empty() && body.contains("client")) return refusal("\"client\" has 1 to 40 letters, digits, - and _");
  return out;
}

std::string preview_text(const Rig& rig, const PreviewedLight& light) {
  json out = {{"reflections", light.reflections}, {"text", light.text}};
  json& fixtures = out["fixtures"] = json::array();
  for (const PreviewedFixture& one : light.fixtures) {
    json entry = {{"fixture", rig.fixtures[one.fixture].name},
                  {"level", one.level},
                  {"pan_deg", deg_from_rad(one.joints.pan_rad)},
                  {"tilt_deg", deg_from_rad(one.joints.tilt_rad)},
                  {"reached", one.reached},
                  {"why", one.why}};
    if (one.by_a_person) entry["by_a_person"] = true;
    fixtures.push_back(std::move(entry));
  }
  json& points = out["points"] = json::array();
  for (std::size_t p = 0; p < light.lux.size(); ++p) {
    json entry = {{"name", rig.points[p].name}, {"lux", light.lux[p]}};
    if (!light.standard_error_lux.empty() && std::isfinite(light.standard_error_lux[p]))
      entry["standard_error_lux"] = light.standard_error_lux[p];
    points.push_back(std::move(entry));
  }
  return out.dump(-1, ' ', false, json::error_handler_t::replace);
}

schema::Schema preview_body() {
  using namespace schema;
  const Schema name = {{"type", "string"}, {"format", "fixtures"}};
  const Schema level = between(0, 1);
  Schema aim = vector("m, world: a point to look at");
  aim["items"] = between(-kFarthest_m, kFarthest_m);
  const Schema one = any_of(
      {request({{"fixture", name}, {"level", level}, never("aim"), never("pan_deg"), never("tilt_deg")}),
       request({{"fixture", name}, maybe("level", level), {"aim", aim}, never("pan_deg"), never("tilt_deg")}),
       request(
           {{"fixture", name}, maybe("level", level), {"pan_deg", number()}, {"tilt_deg", number()}, never("aim")})});
  Schema all = list(one, 1);
  all["maxItems"] = kMaxChanges;
  return request({{"fixtures", all},
                  maybe("reflections", yes_or_no("with reflected light; else that is taken as it is now")),
                  maybe("client", Schema{{"type", "string"}, {"pattern", kQuestionId}})});
}

schema::Schema preview_answer() {
  using namespace schema;
  const Schema fixture = answer({{"fixture", text()},
                                 {"level", between(0, 1, "within its most")},
                                 {"pan_deg", number("that reach the aim")},
                                 {"tilt_deg", number()},
                                 {"reached", yes_or_no("false: it is taken as it is now")},
                                 {"why", text("it is not reached, or is not quite so")},
                                 maybe("by_a_person", yes())});
  const Schema point =
      answer({{"name", text()}, {"lux", at_least(0)}, maybe("standard_error_lux", at_least(0, "with reflections"))});
  return answer({{"reflections", yes_or_no()},
                 {"text", text("why they are not there though asked for")},
                 {"fixtures", list(fixture)},
                 {"points", list(point)}});
}

}  // namespace luxrig
