#include "core/goals/painting_file.h"

#include <fmt/format.h>

#include <cmath>

#include "core/text/json_reader.h"

namespace luxrig {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

constexpr int kVersion = 1;
constexpr double kUnitWithin = 1e-3;
constexpr StrokeKind kKinds[] = {StrokeKind::brush, StrokeKind::bucket, StrokeKind::selective, StrokeKind::eraser};

OrderedJson json_of(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

OrderedJson json_of(const Stroke& stroke) {
  OrderedJson json{{"kind", name_of(stroke.kind)}};
  if (stroke.kind != StrokeKind::eraser) json["lux"] = stroke.lux;
  if (stroke.kind == StrokeKind::brush) {
    json["radius_m"] = stroke.radius_m;
    json["falloff"] = stroke.falloff;
  }
  json["path"] = OrderedJson::array();
  for (const SurfacePlace& place : stroke.path)
    json["path"].push_back({{"position", json_of(place.position_world_m)}, {"normal", json_of(place.normal_world)}});
  return json;
}

/// A number from low to high; low, with a problem, if it is not.
double number_within(const JsonReader& reader, const Json& json, const std::string& path, const char* key, double low,
                     double high, const std::string& mend) {
  const double value = reader.number(json, path, key, true);
  if (value >= low && value <= high) return value;
  if (!std::isnan(value)) reader.problem(fmt::format("{}/{} is {:g}", path, key, value), mend);
  return low;
}

std::optional<StrokeKind> kind_of(const JsonReader& reader, const Json& json, const std::string& path) {
  const std::string name = reader.text(json, path, "kind", true);
  for (const StrokeKind kind : kKinds)
    if (name == name_of(kind)) return kind;
  if (!name.empty())
    reader.problem(fmt::format("{}/kind is not known", path),
                   "give \"brush\", \"bucket\", \"selective\" or \"eraser\"");
  return std::nullopt;
}

SurfacePlace place_of(const JsonReader& reader, const Json& json, const std::string& path) {
  SurfacePlace place;
  for (const auto& [key, vector] : {std::pair{"position", &place.position_world_m}, {"normal", &place.normal_world}}) {
    if (!reader.member(json, path, key, true)) continue;
    if (const auto given = reader.vector(json, path, key)) *vector = *given;
  }
  if (!(std::abs(place.normal_world.norm() - 1) < kUnitWithin))
    reader.problem(fmt::format("{}/normal has length {:g}", path, place.normal_world.norm()), "give a length of 1");
  return place;
}

Stroke stroke_of(const JsonReader& reader, const Json& json, const std::string& path) {
  constexpr double kAny = std::numeric_limits<double>::max();
  Stroke stroke;
  const auto kind = kind_of(reader, json, path);
  if (!kind) return stroke;
  stroke.kind = *kind;
  if (*kind != StrokeKind::eraser)
    stroke.lux =
        number_within(reader, json, path, "lux", 0, kMaxStroke_lx, fmt::format("give 0 to {:g} lx", kMaxStroke_lx));
  if (*kind == StrokeKind::brush) {
    stroke.radius_m = number_within(reader, json, path, "radius_m", 0, kAny, "give 0 or more");
    stroke.falloff = number_within(reader, json, path, "falloff", 0, 1, "give 0 to 1");
  }
  reader.each(json, path, "path", true, [&](const Json& place, const std::string& place_path) {
    stroke.path.push_back(place_of(reader, place, place_path));
  });
  if (stroke.path.empty() || (*kind != StrokeKind::brush && stroke.path.size() > 1))
    reader.problem(fmt::format("{}/path has {} places", path, stroke.path.size()),
                   *kind == StrokeKind::brush ? "give one or more" : "give one");
  return stroke;
}

}  // namespace

std::string painting_to_json(std::span<const Stroke> strokes) {
  std::string text = fmt::format("{{\n \"luxrig_painting\": {},\n \"strokes\": [", kVersion);
  for (std::size_t i = 0; i < strokes.size(); ++i)
    text += fmt::format("{}\n  {}", i == 0 ? "" : ",", json_of(strokes[i]).dump());
  return text + "\n ]\n}\n";
}

Checked<std::vector<Stroke>> painting_from_json(const std::string& text, const std::string& file_name) {
  JsonReader reader(file_name, "a painting", "paint it anew");
  const auto document = reader.document(text);
  if (!document) return tl::unexpected(reader.problems(text));
  reader.require_version(*document, "luxrig_painting", kVersion);
  std::vector<Stroke> strokes;
  reader.each(*document, "", "strokes", true,
              [&](const Json& stroke, const std::string& path) { strokes.push_back(stroke_of(reader, stroke, path)); });
  if (reader.any_problem()) return tl::unexpected(reader.problems(text));
  return strokes;
}

}  // namespace luxrig
