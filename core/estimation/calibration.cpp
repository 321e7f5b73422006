#include "core/estimation/calibration.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/text/json_reader.h"

namespace luxrig {
namespace {

using Json = nlohmann::json;

constexpr const char* kRemedy = "measure the rig again with luxrig calibrate";
/// Farther off, the rig file describes another lamp, another paint or another place.
constexpr double kMostScale = 4, kMostAskew_deg = 20, kMostSpeed_deg_s = 2000, kMostSettling_s = 60;
/// However unsure a measured speed is, so much of it is believed.
constexpr double kSurelySpeed = 0.3;
constexpr double kMostRatio = 10, kMostOffset_m = 5, kMostTurn_deg = 180;
/// The scale of a camera's light may be any: shares of full scale, or cd/m².
constexpr double kMostResponse = 1e6, kMostDistortion = 1, kMostLens = 10, kMostStray = 1, kLeastFov_deg = 0.1;
constexpr const char* kLensKeys[] = {"lens_a", "lens_b", "lens_c"};

/// A lamp lights a point if it gives this share of the brightest that it gives. Its light is never known better than the
/// least.
constexpr double kLights = 0.1, kSmallestLocal = 0.01;

Json pair_of(const Known& known) { return Json::array({known.value, known.standard_error}); }
Json triple_of(const Vec3& v) { return Json::array({v.x(), v.y(), v.z()}); }

/// A value over what the file states, with its error.
Known ratio_of(const JsonReader& reader, const Json& json, const std::string& path, const char* key) {
  const auto pair = reader.pair(json, path, key);
  if (!pair) {
    if (!json.contains(key)) reader.problem(fmt::format("{}/{} is missing", path, key), kRemedy);
    return {1, 0};
  }
  if (!(pair->x() > 1 / kMostRatio && pair->x() < kMostRatio) || !(pair->y() >= 0 && pair->y() < kMostRatio)) {
    reader.problem(fmt::format("{}/{} is [{}, {}]", path, key, pair->x(), pair->y()),
                   fmt::format("give a ratio from {} to {} and its standard error", 1 / kMostRatio, kMostRatio));
    return {1, 0};
  }
  return {pair->x(), pair->y()};
}

Vec3 within(const JsonReader& reader, const Json& json, const std::string& path, const char* key, double most) {
  const Vec3 value = reader.vector(json, path, key).value_or(Vec3::Zero());
  if (value.allFinite() && value.cwiseAbs().maxCoeff() <= most) return value;
  reader.problem(fmt::format("{}/{} is [{}, {}, {}]", path, key, value.x(), value.y(), value.z()),
                 fmt::format("give three numbers from {} to {}", -most, most));
  return Vec3::Zero();
}

Known number_of(const JsonReader& reader, const Json& json, const std::string& path, const char* key, double least,
                double most) {
  const auto pair = reader.pair(json, path, key);
  if (!pair) return {};
  if (pair->x() >= least && pair->x() <= most && pair->y() >= 0 && pair->y() <= most - least)
    return {pair->x(), pair->y()};
  reader.problem(fmt::format("{}/{} is [{}, {}]", path, key, pair->x(), pair->y()),
                 fmt::format("give a number from {} to {} and its standard error", least, most));
  return {};
}

Known scale_of(const JsonReader& reader, const Json& json, const std::string& path, const char* key) {
  const auto pair = reader.pair(json, path, key);
  if (pair && std::abs(pair->x()) >= 1 / kMostScale && std::abs(pair->x()) <= kMostScale && pair->y() >= 0 &&
      pair->y() <= kMostScale)
    return {pair->x(), pair->y()};
  if (pair || !json.contains(key))
    reader.problem(fmt::format("{}/{} is missing, next to 0, or too large", path, key), kRemedy);
  return {1, 0};
}

std::optional<CalibratedHead> head_of(const JsonReader& reader, const Json& json, const std::string& fixture_path) {
  const Json* entry = reader.member(json, fixture_path, "head", false);
  if (!entry) return std::nullopt;
  if (!entry->is_object()) {
    reader.wrong_type(fixture_path, "head", "an object in braces", *entry);
    return std::nullopt;
  }
  const std::string path = fixture_path + "/head";
  CalibratedHead head;
  reader.read_yes_no(*entry, path, "upside_down", head.upside_down);
  head.pan_scale = scale_of(reader, *entry, path, "pan_scale");
  head.tilt_scale = scale_of(reader, *entry, path, "tilt_scale");
  head.tilt_zero_deg = number_of(reader, *entry, path, "tilt_zero_deg", -kMostAskew_deg, kMostAskew_deg);
  head.askew_deg = number_of(reader, *entry, path, "askew_deg", -kMostAskew_deg, kMostAskew_deg);
  head.pan_backlash_deg = number_of(reader, *entry, path, "pan_backlash_deg", -kMostAskew_deg, kMostAskew_deg);
  head.tilt_backlash_deg = number_of(reader, *entry, path, "tilt_backlash_deg", -kMostAskew_deg, kMostAskew_deg);
  head.pan_speed_deg_s = number_of(reader, *entry, path, "pan_speed_deg_s", 0, kMostSpeed_deg_s);
  head.tilt_speed_deg_s = number_of(reader, *entry, path, "tilt_speed_deg_s", 0, kMostSpeed_deg_s);
  head.settling_s = number_of(reader, *entry, path, "settling_s", 0, kMostSettling_s);
  return head;
}

Json json_of(const CalibratedHead& head) {
  Json json;
  json["upside_down"] = head.upside_down;
  json["pan_scale"] = pair_of(head.pan_scale);
  json["tilt_scale"] = pair_of(head.tilt_scale);
  json["tilt_zero_deg"] = pair_of(head.tilt_zero_deg);
  json["askew_deg"] = pair_of(head.askew_deg);
  json["pan_backlash_deg"] = pair_of(head.pan_backlash_deg);
  json["tilt_backlash_deg"] = pair_of(head.tilt_backlash_deg);
  for (const auto& [key, measured] : {std::pair{"pan_speed_deg_s", head.pan_speed_deg_s},
                                      {"tilt_speed_deg_s", head.tilt_speed_deg_s},
                                      {"settling_s", head.settling_s}})
    if (measured.standard_error > 0) json[key] = pair_of(measured);
  return json;
}

std::optional<FirstOutput> first_of(const JsonReader& reader, const Json& json, const std::string& fixture_path) {
  const Json* entry = reader.member(json, fixture_path, "first", false);
  if (!entry) return std::nullopt;
  if (!entry->is_object()) {
    reader.wrong_type(fixture_path, "first", "an object in braces", *entry);
    return std::nullopt;
  }
  const std::string path = fixture_path + "/first";
  return FirstOutput{reader.text(*entry, path, "since", true), ratio_of(reader, *entry, path, "output")};
}

/// Puts the head where it was found to hang. Its joints are true ones from then on.
void turn_as_found(const CalibratedHead& head, Fixture& fixture) {
  if (head.upside_down) fixture.world_from_mount.rotation *= Vec3(1, -1, -1).asDiagonal();
  JointMap map;
  map.pan_scale = head.pan_scale.value;
  map.tilt_scale = head.tilt_scale.value;
  map.pan_play_rad = rad_from_deg(head.pan_backlash_deg.value);
  map.tilt_play_rad = rad_from_deg(head.tilt_backlash_deg.value);
  map.askew_x = std::tan(rad_from_deg(head.askew_deg.value));
  map.askew_y = std::tan(rad_from_deg(head.tilt_zero_deg.value));
  map.sent = fixture.range;
  fixture.range = map.reach();
  const auto within = [&](Joints joints) {
    joints = map.reached_by(joints, {});
    joints.pan_rad = std::clamp(joints.pan_rad, fixture.range.pan_min_rad, fixture.range.pan_max_rad);
    joints.tilt_rad = std::clamp(joints.tilt_rad, fixture.range.tilt_min_rad, fixture.range.tilt_max_rad);
    return joints;
  };
  fixture.joints = within(fixture.joints);
  if (fixture.park) fixture.park = within(*fixture.park);
  // Who waits for it should not wait too short: no faster, and no sooner still, than two standard errors allow.
  const auto speed_rad_s = [](double stated_rad_s, const Known& measured_deg_s, double scale) {
    if (!(measured_deg_s.standard_error > 0)) return stated_rad_s * std::abs(scale);
    return rad_from_deg(
        std::max(measured_deg_s.value - 2 * measured_deg_s.standard_error, kSurelySpeed * measured_deg_s.value));
  };
  if (head.settling_s.standard_error > 0)
    fixture.settles_s = head.settling_s.value + 2 * head.settling_s.standard_error;
  fixture.pan_speed_rad_s = speed_rad_s(fixture.pan_speed_rad_s, head.pan_speed_deg_s, map.pan_scale);
  fixture.tilt_speed_rad_s = speed_rad_s(fixture.tilt_speed_rad_s, head.tilt_speed_deg_s, map.tilt_scale);
  fixture.joint_map = map;
}

MeasuredCurve curve_of(const JsonReader& reader, const Json& json, const std::string& path) {
  MeasuredCurve curve;
  const Json* list = reader.member(json, path, "curve", false);
  if (!list) return curve;
  const auto wrong = [&] {
    reader.wrong_type(path, "curve",
                      "a list of [level, share of full light], both rising from above 0, the last of them [1, 1]",
                      *list);
    return MeasuredCurve{};
  };
  if (!list->is_array()) return wrong();
  for (const Json& entry : *list) {
    if (!entry.is_array() || entry.size() != 2 || !entry[0].is_number() || !entry[1].is_number()) return wrong();
    const std::pair<double, double> next{entry[0].get<double>(), entry[1].get<double>()};
    const auto before = curve.empty() ? std::pair<double, double>{} : curve.back();
    if (!(next.first > before.first && next.second > before.second)) return wrong();
    curve.push_back(next);
  }
  if (curve.size() == 1 || (!curve.empty() && curve.back() != std::pair<double, double>{1, 1})) return wrong();
  return curve;
}

/// Calls body(name, entry, path) for each member of an object of objects.
template <class Body>
void each_named(const JsonReader& reader, const Json& json, const char* key, Body body) {
  const Json* all = reader.member(json, "", key, false);
  if (!all) return;
  if (!all->is_object()) return reader.wrong_type("", key, "an object in braces", *all);
  for (const auto& [name, entry] : all->items()) {
    // A name with a slash would lead elsewhere as a path, so paths end at the list.
    if (entry.is_object())
      body(name, entry, fmt::format("/{}", key));
    else
      reader.problem(fmt::format("/{}: \"{}\" is {}, not an object", key, name, entry.type_name()), kRemedy);
  }
}

CalibratedCamera camera_of(const JsonReader& reader, const Json& entry, const std::string& name,
                           const std::string& path) {
  CalibratedCamera camera;
  camera.name = name;
  camera.offset_m = within(reader, entry, path, "offset_m", kMostOffset_m);
  camera.offset_error_m = within(reader, entry, path, "offset_error_m", kMostOffset_m).cwiseAbs();
  camera.turn_deg = within(reader, entry, path, "turn_deg", kMostTurn_deg);
  camera.turn_error_deg = within(reader, entry, path, "turn_error_deg", kMostTurn_deg).cwiseAbs();
  // Its picture has a width and a height, so neither end is one.
  camera.fov_deg = number_of(reader, entry, path, "fov_deg", kLeastFov_deg, 180 - kLeastFov_deg);
  if (!(camera.fov_deg.value > 0) && !entry.contains("fov_deg")) reader.problem(path + "/fov_deg is missing", kRemedy);
  camera.distortion = number_of(reader, entry, path, "distortion", -kMostDistortion, kMostDistortion);
  for (std::size_t k = 0; k < camera.lens_loss.size(); ++k)
    camera.lens_loss[k] = number_of(reader, entry, path, kLensKeys[k], -kMostLens, kMostLens);
  camera.flare = number_of(reader, entry, path, "flare", -kMostStray, kMostStray);
  camera.halo = number_of(reader, entry, path, "halo", -kMostStray, kMostStray);
  const Json* responses = reader.member(entry, path, "response", false);
  if (!responses) return camera;
  if (!responses->is_object()) {
    reader.wrong_type(path, "response", "an object in braces", *responses);
    return camera;
  }
  for (const auto& [luminaire, value] : responses->items()) {
    const auto pair = reader.pair(*responses, path + "/response", luminaire.c_str());
    if (!pair) continue;
    if (pair->x() >= 1 / kMostResponse && pair->x() <= kMostResponse && pair->y() >= 0 && pair->y() <= kMostResponse)
      camera.responses.emplace_back(luminaire, Known{pair->x(), pair->y()});
    else
      reader.wrong_type(path + "/response", luminaire.c_str(), "[what it shows over the light, its standard error]",
                        value);
  }
  return camera;
}

Json json_of(const CalibratedCamera& camera) {
  Json json;
  json["offset_m"] = triple_of(camera.offset_m);
  json["offset_error_m"] = triple_of(camera.offset_error_m);
  json["turn_deg"] = triple_of(camera.turn_deg);
  json["turn_error_deg"] = triple_of(camera.turn_error_deg);
  json["fov_deg"] = pair_of(camera.fov_deg);
  json["distortion"] = pair_of(camera.distortion);
  for (std::size_t k = 0; k < camera.lens_loss.size(); ++k) json[kLensKeys[k]] = pair_of(camera.lens_loss[k]);
  json["flare"] = pair_of(camera.flare);
  json["halo"] = pair_of(camera.halo);
  json["response"] = Json::object();
  for (const auto& [luminaire, response] : camera.responses) json["response"][luminaire] = pair_of(response);
  return json;
}

/// What a calibration leaves uncertain of a lamp. Beside its output: of its light at the points that it lights.
LightError error_of(const Calibration& calibration, const CalibratedFixture& fixture) {
  double brightest = 0;
  for (const CalibratedLight& light : calibration.lights)
    if (light.fixture == fixture.name) brightest = std::max(brightest, light.lux.value);
  double variance = 0, least = std::numeric_limits<double>::infinity(), points = 0;
  for (const CalibratedLight& light : calibration.lights) {
    if (light.fixture != fixture.name || !(light.lux.value > kLights * brightest)) continue;
    const double of_point = std::pow(light.lux.standard_error / light.lux.value, 2);
    variance += of_point;
    least = std::min(least, of_point);
    ++points;
  }
  const bool measured = fixture.output.standard_error > 0;
  const double output = measured ? fixture.output.standard_error / fixture.output.value : 0;
  const auto beside_output = [&](double of_points) {
    const double local = points > 0 ? std::sqrt(std::max(0.0, of_points - output * output)) : 0;
    return std::max({local, fixture.curve_error, kSmallestLocal});
  };
  return {measured ? output : std::numeric_limits<double>::quiet_NaN(), beside_output(variance / points),
          beside_output(least)};
}

/// What was found of lamps that shine where they do in the rig file.
void put_known_lights(const Calibration& calibration, Rig& rig) {
  if (calibration.as_found == 0) return;
  rig.known_lights_of = calibration.as_found;
  for (const CalibratedLight& light : calibration.lights) {
    const auto point =
        std::find_if(rig.points.begin(), rig.points.end(), [&](const Point& each) { return each.name == light.point; });
    const auto fixture = std::find_if(rig.fixtures.begin(), rig.fixtures.end(),
                                      [&](const Fixture& each) { return each.name == light.fixture; });
    if (point == rig.points.end() || fixture == rig.fixtures.end() || fixture->moves || !(light.lux.value > 0))
      continue;
    rig.known_lights.push_back({static_cast<std::size_t>(point - rig.points.begin()),
                                static_cast<std::size_t>(fixture - rig.fixtures.begin()), light.lux.value,
                                light.lux.standard_error});
  }
}

}  // namespace

std::string to_json(const Calibration& calibration) {
  Json json;
  json["luxrig_calibration"] = 1;
  json["rig"] = calibration.rig;
  json["made"] = calibration.made;
  json["made_for"] = fmt::format("{:016x}", calibration.made_for);
  if (calibration.as_found != 0) json["as_found"] = fmt::format("{:016x}", calibration.as_found);
  if (!calibration.simulated.empty()) json["simulated"] = calibration.simulated;
  json["fixtures"] = json["materials"] = json["luxmeters"] = json["points"] = Json::object();
  for (const CalibratedFixture& fixture : calibration.fixtures) {
    Json& entry = json["fixtures"][fixture.name];
    entry["output"] = pair_of(fixture.output);
    if (fixture.first) entry["first"] = {{"since", fixture.first->since}, {"output", pair_of(fixture.first->output)}};
    entry["offset_m"] = triple_of(fixture.offset_m);
    entry["offset_error_m"] = triple_of(fixture.offset_error_m);
    entry["turn_deg"] = triple_of(fixture.turn_deg);
    entry["turn_error_deg"] = triple_of(fixture.turn_error_deg);
    if (fixture.head) entry["head"] = json_of(*fixture.head);
    if (fixture.curve.empty()) continue;
    entry["curve_error"] = fixture.curve_error;
    for (const auto& [level, share] : fixture.curve) entry["curve"].push_back(Json::array({level, share}));
  }
  for (const CalibratedMaterial& material : calibration.materials)
    json["materials"][material.name]["reflectance"] = pair_of(material.reflectance);
  for (const CalibratedLuxmeter& luxmeter : calibration.luxmeters)
    json["luxmeters"][luxmeter.name]["gain"] = pair_of(luxmeter.gain);
  for (const CalibratedLight& light : calibration.lights)
    json["points"][light.point][light.fixture] = pair_of(light.lux);
  for (const CalibratedCamera& camera : calibration.cameras) json["cameras"][camera.name] = json_of(camera);
  return json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n";
}

Checked<Calibration> calibration_from_json(const std::string& text, const std::string& file_name) {
  JsonReader reader(file_name, "a calibration", kRemedy);
  const auto document = reader.document(text);
  if (!document) return tl::unexpected(reader.problems(text));
  const Json& json = *document;
  reader.require_version(json, "luxrig_calibration", 1);
  Calibration calibration;
  calibration.rig = reader.text(json, "", "rig", true);
  calibration.made = reader.text(json, "", "made", true);
  calibration.made_for = reader.fingerprint(json, "", "made_for");
  calibration.as_found = reader.fingerprint(json, "", "as_found");
  calibration.simulated = reader.text(json, "", "simulated", false);
  each_named(reader, json, "fixtures", [&](const std::string& name, const Json& entry, const std::string& list) {
    const std::string path = list + "/" + name;
    CalibratedFixture fixture;
    fixture.name = name;
    fixture.output = ratio_of(reader, entry, path, "output");
    fixture.first = first_of(reader, entry, path);
    fixture.offset_m = within(reader, entry, path, "offset_m", kMostOffset_m);
    fixture.offset_error_m = within(reader, entry, path, "offset_error_m", kMostOffset_m).cwiseAbs();
    fixture.turn_deg = within(reader, entry, path, "turn_deg", kMostTurn_deg);
    fixture.turn_error_deg = within(reader, entry, path, "turn_error_deg", kMostTurn_deg).cwiseAbs();
    fixture.head = head_of(reader, entry, path);
    fixture.curve = curve_of(reader, entry, path);
    fixture.curve_error = reader.optional_number(entry, path, "curve_error").value_or(0);
    calibration.fixtures.push_back(std::move(fixture));
  });
  each_named(reader, json, "materials", [&](const std::string& name, const Json& entry, const std::string& list) {
    calibration.materials.push_back({name, ratio_of(reader, entry, list + "/" + name, "reflectance")});
  });
  each_named(reader, json, "luxmeters", [&](const std::string& name, const Json& entry, const std::string& list) {
    calibration.luxmeters.push_back({name, ratio_of(reader, entry, list + "/" + name, "gain")});
  });
  each_named(reader, json, "points", [&](const std::string& point, const Json& entry, const std::string& list) {
    for (const auto& [fixture, value] : entry.items()) {
      const auto lux = reader.pair(entry, list + "/" + point, fixture.c_str());
      if (!lux) continue;
      if (lux->allFinite() && lux->minCoeff() >= 0)
        calibration.lights.push_back({point, fixture, {lux->x(), lux->y()}});
      else
        reader.wrong_type(list + "/" + point, fixture.c_str(), "[lux, its standard error], none below 0", value);
    }
  });
  each_named(reader, json, "cameras", [&](const std::string& name, const Json& entry, const std::string& list) {
    calibration.cameras.push_back(camera_of(reader, entry, name, list + "/" + name));
  });
  if (reader.any_problem()) return tl::unexpected(reader.problems(text));
  return calibration;
}

Checked<Rig> calibrated(Rig rig, const Calibration& calibration, const std::string& file_name) {
  std::vector<Problem> problems;
  const auto problem = [&](std::string what, std::string mend) {
    problems.push_back({file_name, 0, 0, std::move(what), std::move(mend)});
  };
  if (calibration.rig != rig.name)
    problem(fmt::format("it is of rig \"{}\", this is \"{}\"", calibration.rig, rig.name), kRemedy);
  for (const CalibratedFixture& found : calibration.fixtures)
    if (std::none_of(rig.fixtures.begin(), rig.fixtures.end(),
                     [&](const Fixture& each) { return each.name == found.name; }))
      problem(fmt::format("the rig has no fixture \"{}\"", found.name), kRemedy);
  // In the rig's order, so that the rig is the same in whichever order it was found.
  for (auto fixture = rig.fixtures.begin(); fixture != rig.fixtures.end(); ++fixture) {
    const auto of_fixture = std::find_if(calibration.fixtures.begin(), calibration.fixtures.end(),
                                         [&](const CalibratedFixture& each) { return each.name == fixture->name; });
    if (of_fixture == calibration.fixtures.end()) continue;
    const CalibratedFixture& found = *of_fixture;
    fixture->world_from_mount = displaced(fixture->world_from_mount, found.offset_m, found.turn_deg * (kPi / 180));
    if (found.head && fixture->moves) turn_as_found(*found.head, *fixture);
    fixture->measured_curve = found.curve;
    fixture->known_to = error_of(calibration, found);
    if (fixture->moves && fixture->aim_world_m) {
      const Vec3 direction_world = *fixture->aim_world_m - fixture->world_from_mount.translation_m;
      const auto reached =
          pan_tilt_towards(fixture->world_from_mount, direction_world, fixture->range, fixture->joints);
      if (reached)
        fixture->joints = *reached;
      else
        problem(fmt::format("as \"{}\" was found to hang, its aim is out of its reach", found.name),
                "aim it at another place, or hang it right and calibrate again");
    }
    if (found.output.value == 1) continue;
    Luminaire luminaire = rig.luminaires[fixture->luminaire];
    luminaire.lumens *= found.output.value;
    luminaire.intensity = scaled_to_flux(luminaire.intensity, found.output.value * luminaire.intensity->flux_lm());
    fixture->luminaire = rig.luminaires.size();
    rig.luminaires.push_back(std::move(luminaire));
  }
  for (const CalibratedMaterial& material : calibration.materials)
    rig.scene.paint.emplace_back(material.name, material.reflectance.value);
  if (!problems.empty()) return tl::unexpected(std::move(problems));
  put_known_lights(calibration, rig);
  rig.calibrated = calibration.made;
  rig.calibrated_on = calibration.simulated;
  return rig;
}

std::filesystem::path calibration_file(const Rig& rig) { return rig.file.parent_path() / "calibration.json"; }

}  // namespace luxrig
