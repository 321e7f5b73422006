#include <fmt/format.h>

#include <string_view>

#include "core/photometry/light_colour.h"
#include "core/photometry/photometric_file.h"
#include "core/rig/rig_reader.h"

namespace luxrig {
namespace {

/// Keys that belong to some models only.
struct ModelKey {
  const char* key;
  const char* models;  ///< with a blank about each
  bool required;
};
constexpr ModelKey kModelKeys[] = {
    {"file", " ies ", true},
    {"beam_angle_deg", " spot ", true},
    {"field_angle_deg", " spot ", true},
    {"length_m", " rectangle cylinder ", true},
    {"width_m", " rectangle ", true},
    {"diameter_m", " disk sphere cylinder ", true},
    {"near_field", " ies ", false},
};
constexpr const char* kModelNames[] = {"ies", "isotropic", "spot", "rectangle", "disk", "sphere", "cylinder"};

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

}  // namespace

void RigReader::check_model_keys(Section& s, LuminaireModel model) {
  const std::string name = kModelNames[static_cast<int>(model)];
  for (const ModelKey& key : kModelKeys) {
    const bool belongs = std::string_view(key.models).find(" " + name + " ") != std::string_view::npos;
    if (!belongs) {
      s.refuse(key.key, fmt::format("{} has no effect on this model", key.key),
               fmt::format("write model = {}, or remove {}", models_text(key.models),
                           std::string_view(key.key) == "file" ? "the file" : "this key"));
    } else if (key.required && !s.has(key.key)) {
      s.require(key.key, fmt::format("which model \"{}\" needs", name));
    }
  }
  if (model != LuminaireModel::ies && !s.has("lumens")) s.require("lumens", "which this model needs");
}

void RigReader::read_spot(Section& s, Luminaire& luminaire) {
  const bool beam = s.read_deg("beam_angle_deg", luminaire.beam_angle_rad);
  const bool field = s.read_deg("field_angle_deg", luminaire.field_angle_rad);
  if (!beam || !field) return;
  if (luminaire.beam_angle_rad >= luminaire.field_angle_rad) {
    problems.add(s.place_of("beam_angle_deg"),
                 fmt::format("beam_angle_deg {:g} is not below field_angle_deg {:g}",
                             deg_from_rad(luminaire.beam_angle_rad), deg_from_rad(luminaire.field_angle_rad)),
                 "the beam angle is to half the peak, the field angle to a tenth: swap or correct them");
    return;
  }
  if (luminaire.lumens > 0) {
    luminaire.intensity = make_spot(luminaire.lumens, luminaire.beam_angle_rad, luminaire.field_angle_rad);
  }
}

void RigReader::read_photometric_file(Section& s, Luminaire& luminaire) {
  bool near_field = false;
  s.read("near_field", near_field);
  const auto path = read_file(s, "file");
  if (!path) return;
  luminaire.ies_path = *path;
  Checked<PhotometricFile> file = load_photometric_file(*path);
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
    if (!s.has("lumens")) luminaire.lumens = flux_lm;
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

void RigReader::read_colour(Section& s, Luminaire& luminaire) {
  if (s.has("cct_k") && s.has("colour")) {
    problems.add(s.place_of("colour"), "cct_k and colour both say what colour its light has", "remove one of the two");
    return;
  }
  double cct_k = 0;
  if (s.read("cct_k", cct_k)) luminaire.colour_rgb = rgb_of_cct(cct_k);
  Vec3 rgb = Vec3::Ones();
  if (!s.read("colour", rgb)) return;
  if (const auto scaled = with_luminance_1(rgb)) {
    luminaire.colour_rgb = *scaled;
  } else {
    problems.add(s.place_of("colour"), "a colour of light cannot be black", "give at least one number above 0");
  }
}

void RigReader::read_distribution(Section& s, Luminaire& luminaire) {
  if (!s.read_choice("model", luminaire.model)) return;
  check_model_keys(s, luminaire.model);
  s.read("lumens", luminaire.lumens);  // stays 0 when it is absent or wrong
  switch (luminaire.model) {
    case LuminaireModel::ies:
      read_photometric_file(s, luminaire);
      break;
    case LuminaireModel::spot:
      read_spot(s, luminaire);
      break;
    case LuminaireModel::isotropic:
      if (luminaire.lumens > 0) luminaire.intensity = make_isotropic(luminaire.lumens);
      break;
    default:
      read_luminous_surface(s, luminaire);
  }
  read_colour(s, luminaire);
}

void RigReader::read_luminaires() {
  each(root, "luminaire", [&](Section& s) {
    Luminaire luminaire;
    luminaire.place = s.place();
    if (s.read("name", luminaire.name)) {
      luminaires.add(luminaire.name, rig.luminaires.size(), s.place_of("name"), problems);
    }
    read_distribution(s, luminaire);
    s.read("watts", luminaire.watts);
    rig.luminaires.push_back(std::move(luminaire));
  });
}

}  // namespace luxrig
