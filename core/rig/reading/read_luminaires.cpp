#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/photometry/light_colour.h"
#include "core/rig/luminaire_file/luminaire_file.h"
#include "core/rig/reading/rig_reader.h"
#include "core/rig/reading/stated_light.h"

namespace luxrig {
namespace {

/// Keys that belong to some models only.
struct ModelKey {
  const char* key;
  const char* models;  ///< with a blank before and after each
  bool required;
};
constexpr ModelKey kModelKeys[] = {
    {"file", " ies ", true},
    {"file_variant", " ies ", false},
    {"file_emitter", " ies ", false},
    {"beam_angle_deg", " spot ", true},
    {"field_angle_deg", " spot ", true},
    {"zoom_deg", " spot ", false},
    {"exponent", " cosine ", true},
    {"length_m", " rectangle cylinder ", true},
    {"width_m", " rectangle ", true},
    {"diameter_m", " disk sphere cylinder ", true},
    {"near_field", " ies ", false},
};
constexpr double kZoomRounding_deg = 1e-9;

std::string models_text(std::string_view models) {
  std::string text;
  while (models.size() > 1) {
    models.remove_prefix(1);
    const std::size_t end = models.find(' ');
    text += fmt::format("{}\"{}\"", text.empty() ? "" : " or ", models.substr(0, end));
    models.remove_prefix(end);
  }
  return text;
}

/// "" if the luminaire has no maker's file.
std::string why_not_stated(const StatedLight& stated) {
  if (stated.file.empty()) return "";
  const BeamGeometry& l = stated.light;
  if (l.lumens == 0 && l.beam_angle_deg == 0) return fmt::format(" ({} states none)", in_quotes(stated.file));
  return fmt::format(" ({} states {:g} lm, a beam of {:g}° and a field of {:g}°)", in_quotes(stated.file), l.lumens,
                     l.beam_angle_deg, l.field_angle_deg);
}

}  // namespace

void RigReader::check_model_keys(Section& s, LuminaireModel model, const StatedLight& stated) {
  std::string name;
  s.read("model", name);
  for (const ModelKey& key : kModelKeys) {
    const bool belongs = std::string_view(key.models).find(" " + name + " ") != std::string_view::npos;
    if (!belongs) {
      s.refuse(key.key, fmt::format("{} has no effect on this model", key.key),
               fmt::format("write model = {}, or remove {}", models_text(key.models),
                           std::string_view(key.key) == "file" ? "the file" : "this key"));
    } else if (key.required && !s.has(key.key)) {
      if (model == LuminaireModel::spot && states_spot(stated.light) && !s.has("beam_angle_deg") &&
          !s.has("field_angle_deg"))
        continue;
      s.require(key.key, fmt::format("which model \"{}\" needs", name) + why_not_stated(stated));
    }
  }
  if (model != LuminaireModel::ies && !s.has("lumens") && !s.has("emitters") && !states_lumens(stated.light))
    s.require("lumens", "which this model needs" + why_not_stated(stated));
}

void RigReader::read_spot(Section& s, Luminaire& luminaire) {
  s.read_deg("beam_angle_deg", luminaire.beam_angle_rad);  // if absent: 0, or as its maker's file states
  s.read_deg("field_angle_deg", luminaire.field_angle_rad);
  if (!(luminaire.beam_angle_rad > 0) || !(luminaire.field_angle_rad > 0)) return;
  if (luminaire.beam_angle_rad >= luminaire.field_angle_rad) {
    problems.add(s.place_of("beam_angle_deg"),
                 fmt::format("beam_angle_deg {:g} is not below field_angle_deg {:g}",
                             deg_from_rad(luminaire.beam_angle_rad), deg_from_rad(luminaire.field_angle_rad)),
                 "the beam angle is to half the peak, the field angle to a tenth: swap or correct them");
    return;
  }
  std::pair<double, double> zoom_deg;
  if (s.read("zoom_deg", zoom_deg)) {
    luminaire.zoom_beam_rad = {rad_from_deg(zoom_deg.first), rad_from_deg(zoom_deg.second)};
    const double beam_deg = deg_from_rad(luminaire.beam_angle_rad);
    const double ratio = luminaire.field_angle_rad / luminaire.beam_angle_rad;
    if (beam_deg < zoom_deg.first - kZoomRounding_deg || beam_deg > zoom_deg.second + kZoomRounding_deg) {
      problems.add(s.place_of("beam_angle_deg"),
                   fmt::format("beam_angle_deg {:g} is outside its zoom_deg of {:g} to {:g}", beam_deg, zoom_deg.first,
                               zoom_deg.second),
                   "give a beam angle that its zoom can make, or correct zoom_deg");
      return;
    }
    if (ratio * zoom_deg.second >= 180) {
      problems.add(s.place_of("zoom_deg"),
                   fmt::format("at {:g}° its field angle would be {:g}°, {:g} times as wide as the beam, as "
                               "field_angle_deg and beam_angle_deg say",
                               zoom_deg.second, ratio * zoom_deg.second, ratio),
                   "a field angle is below 180°: lower zoom_deg, or state a narrower field");
      return;
    }
  }
  if (luminaire.lumens > 0) {
    luminaire.intensity = make_spot(luminaire.lumens, luminaire.beam_angle_rad, luminaire.field_angle_rad);
  }
}

void RigReader::read_photometric_file(Section& s, Luminaire& luminaire) {
  const bool near_field = s.yes_no("near_field");
  LuminairePart part;
  for (const auto& [key, to] : {std::pair{"file_variant", &part.variant}, {"file_emitter", &part.emitter}}) {
    std::string name;
    if (s.read(key, name)) *to = name;
  }
  const auto path = read_file(s, "file");
  if (!path) return;
  luminaire.ies_path = *path;
  Checked<PhotometricFile> file = load_luminaire_file(*path, part);
  if (!file) {
    problems.add(s.place_of("file"), fmt::format("{} cannot be used", in_quotes(path->filename().string())),
                 "mend what is listed for it, or use another file");
    for (const Problem& problem : file.error()) problems.add(problem);
    return;
  }
  const auto note = [&](const std::string& what) {
    rig.notes.push_back({path->string(), 0, 0, what, "check the file against the maker's data sheet"});
  };
  for (const std::string& warning : file->warnings) note(warning);
  if (near_field) {
    luminaire.shape = file->opening.shape;
    if (!file->opening.note.empty()) note(file->opening.note);
    if (file->opening.shape.kind == LuminousShape::Kind::point && file->opening.note.empty()) {
      note("it states no luminous opening: near_field has no effect");
    }
  }
  luminaire.tilt = std::move(file->tilt);
  const double flux_lm = file->intensity->flux_lm();
  if (luminaire.lumens > 0) {
    luminaire.intensity = scaled_to_flux(std::move(file->intensity), luminaire.lumens);
  } else {
    luminaire.intensity = std::move(file->intensity);
    if (!s.has("lumens") && !s.has("emitters")) luminaire.lumens = flux_lm;
  }
}

void RigReader::read_luminous_surface(Section& s, Luminaire& luminaire) {
  using Kind = LuminousShape::Kind;
  double length_m = 0, width_m = 0, diameter_m = 0;
  s.read("length_m", length_m);
  s.read("width_m", width_m);
  s.read("diameter_m", diameter_m);
  const bool lit = luminaire.lumens > 0;
  switch (luminaire.model) {
    case LuminaireModel::rectangle:
      luminaire.shape = {Kind::rectangle, Vec3(length_m, width_m, 0)};
      if (lit) luminaire.intensity = make_lambertian(luminaire.lumens);
      break;
    case LuminaireModel::disk:
      luminaire.shape = {Kind::disk, Vec3(diameter_m, 0, 0)};
      if (lit) luminaire.intensity = make_lambertian(luminaire.lumens);
      break;
    case LuminaireModel::sphere:
      luminaire.shape = {Kind::sphere, Vec3(diameter_m, 0, 0)};
      if (lit) luminaire.intensity = make_isotropic(luminaire.lumens);
      break;
    default:
      luminaire.shape = {Kind::cylinder, Vec3(diameter_m, 0, length_m)};
      if (lit && diameter_m > 0 && length_m > 0) {
        luminaire.intensity = make_lambertian_cylinder(luminaire.lumens, diameter_m, length_m);
      }
  }
}

void RigReader::note_colour_moved(const std::string& file, const FilePosition& in_file, const std::string& whose,
                                  const Chromaticity& wanted, const Vec3& taken_rgb) {
  const Chromaticity taken = xy_of_rgb(taken_rgb);
  rig.notes.push_back(
      {file, in_file.line, in_file.column,
       fmt::format("{} xy [{:g}, {:g}] lies outside Rec. 709, in which colours are computed: [{:.4f}, {:.4f}] is taken",
                   whose, wanted.x(), wanted.y(), taken.x(), taken.y()),
       "lux stay right; expect the real colour to be more saturated than predicted"});
}

void RigReader::read_colour(Section& s, Vec3& colour_rgb) {
  const char* given = nullptr;
  for (const char* key : {"cct_k", "xy", "colour"}) {
    if (!s.has(key)) continue;
    if (given) {
      problems.add(s.place_of(key), fmt::format("{} and {} both say what colour its light has", given, key),
                   "remove one of the two");
      return;
    }
    given = key;
  }
  double cct_k = 0;
  if (s.read("cct_k", cct_k)) colour_rgb = rgb_of_cct(cct_k);
  Chromaticity xy;
  if (s.read("xy", xy)) {
    const ColourWithin709 colour = within_rec709(rgb_of_xy(xy));
    colour_rgb = colour.rgb;
    if (colour.moved) note_colour_moved(problems.file(), s.place_of("xy"), "the colour", xy, colour.rgb);
  }
  Vec3 rgb = Vec3::Ones();
  if (!s.read("colour", rgb)) return;
  if (const auto scaled = with_luminance_1(rgb)) {
    colour_rgb = *scaled;
  } else {
    problems.add(s.place_of("colour"), "a colour of light cannot be black", "give at least one number above 0");
  }
}

void RigReader::read_distribution(Section& s, StatedLight& stated, Luminaire& luminaire) {
  if (!s.read_choice("model", luminaire.model)) return;
  check_model_keys(s, luminaire.model, stated);
  take_stated_light(s, stated, luminaire);
  if (!s.has("emitters")) s.read("lumens", luminaire.lumens);  // stays 0 if absent or wrong
  switch (luminaire.model) {
    case LuminaireModel::ies:
      read_photometric_file(s, luminaire);
      break;
    case LuminaireModel::spot:
      read_spot(s, luminaire);
      break;
    case LuminaireModel::cosine:
      if (double exponent = 0; s.read("exponent", exponent) && luminaire.lumens > 0)
        luminaire.intensity = make_cosine_power(luminaire.lumens, exponent);
      break;
    case LuminaireModel::isotropic:
      if (luminaire.lumens > 0) luminaire.intensity = make_isotropic(luminaire.lumens);
      break;
    default:
      read_luminous_surface(s, luminaire);
  }
}

std::vector<Luminaire> RigReader::read_emitters(Section& s, const std::string& luminaire_name) {
  std::vector<Luminaire> emitters;
  if (!s.has("emitters")) return emitters;
  for (const char* key : {"lumens", "watts", "cct_k", "xy", "colour"})
    s.refuse(key, fmt::format("{} has no effect beside emitters", key), "remove it: each emitter has its own");
  NameIndex names("emitter");
  each(s.table(), "luminaire.emitters", [&](Section& e) {
    Luminaire emitter;
    emitter.in_file = e.in_file();
    std::string name;
    if (e.read("name", name)) {
      names.add(name, emitters.size(), e.place_of("name"), problems);
      for (const std::string_view ending : {"-fine", "-ultra"}) {
        if (!name.ends_with(ending)) continue;
        problems.add(e.place_of("name"), fmt::format("emitter {} ends in {}", in_quotes(name), ending),
                     fmt::format("name it otherwise: slots call a low byte of an emitter \"emitter:NAME{}\"", ending));
      }
    }
    emitter.name = luminaire_name + "/" + name;
    e.read("lumens", emitter.lumens);
    e.read("watts", emitter.watts);
    read_colour(e, emitter.colour_rgb);
    emitters.push_back(std::move(emitter));
  });
  if (emitters.empty() && problems.empty())
    problems.add(s.place_of("emitters"), "emitters is empty", "list at least one, or remove it and give lumens");
  return emitters;
}

/// All emitters at full, for code that needs the luminaire as a whole.
void RigReader::add_up(const std::vector<Luminaire>& emitters, Luminaire& luminaire) {
  luminaire.lumens = 0;
  luminaire.watts = 0;
  Vec3 light_rgb = Vec3::Zero();
  for (const Luminaire& emitter : emitters) {
    luminaire.lumens += emitter.lumens;
    if (luminaire.watts)
      luminaire.watts = emitter.watts ? std::optional(*luminaire.watts + *emitter.watts) : std::nullopt;
    light_rgb += emitter.lumens * emitter.colour_rgb;
  }
  luminaire.colour_rgb = with_luminance_1(light_rgb).value_or(Vec3::Ones());
}

void RigReader::read_luminaires() {
  each(root, "luminaire", [&](Section& s) {
    Luminaire luminaire;
    luminaire.in_file = s.in_file();
    if (s.read("name", luminaire.name)) {
      luminaires.add(luminaire.name, rig.luminaires.size(), s.place_of("name"), problems);
    }
    std::vector<Luminaire> emitters = read_emitters(s, luminaire.name);
    if (emitters.empty()) {
      read_colour(s, luminaire.colour_rgb);
      s.read("watts", luminaire.watts);
    } else {
      add_up(emitters, luminaire);
    }
    StatedLight stated = light_stated_for(luminaire.name);
    read_distribution(s, stated, luminaire);
    const std::size_t whole = rig.luminaires.size();
    if (!stated.file.empty()) stated_lights.emplace(whole, std::move(stated));
    for (std::size_t e = 0; e < emitters.size(); ++e) luminaire.emitters.push_back(whole + 1 + e);
    rig.luminaires.push_back(luminaire);
    for (auto at = emitters.begin(); at != emitters.end(); ++at) {
      const Luminaire& emitter = *at;
      const auto is_called_so = [&](const Luminaire& other) { return other.name == emitter.name; };
      if (std::none_of(emitters.begin(), at, is_called_so))  // a second one is reported
        luminaires.add(emitter.name, rig.luminaires.size(), emitter.in_file, problems);
      Luminaire part = luminaire;
      part.name = emitter.name;
      part.lumens = emitter.lumens;
      part.watts = emitter.watts;
      part.colour_rgb = emitter.colour_rgb;
      if (part.intensity && part.lumens > 0) part.intensity = scaled_to_flux(part.intensity, part.lumens);
      part.emitters.clear();
      part.emitter_of = whole;
      part.in_file = emitter.in_file;
      rig.luminaires.push_back(std::move(part));
    }
  });
}

}  // namespace luxrig
