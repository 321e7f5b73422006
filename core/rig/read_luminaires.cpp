#include <fmt/format.h>

#include <cmath>

#include "core/photometry/ies.h"
#include "core/rig/rig_reader.h"

namespace luxrig {

void RigReader::read_distribution(Section& s, Luminaire& luminaire) {
  if (!s.read_choice("model", luminaire.model)) return;
  const bool ies = luminaire.model == LuminaireModel::ies, spot = luminaire.model == LuminaireModel::spot;
  if (!ies) s.refuse("file", "file has no effect on this model", "write model = \"ies\", or remove the file");
  for (const char* key : {"beam_angle_deg", "field_angle_deg"}) {
    if (!spot) {
      s.refuse(key, fmt::format("{} has no effect on this model", key), "write model = \"spot\", or remove this key");
    } else if (!s.has(key)) {
      s.require(key, "which model \"spot\" needs");
    }
  }
  if (ies && !s.has("file")) s.require("file", "which model \"ies\" needs");
  if (!ies && !s.has("lumens")) s.require("lumens", "which this model needs");

  const bool lumens = s.read("lumens", luminaire.lumens);
  if (spot) {
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
    if (lumens) {
      luminaire.intensity = make_spot(luminaire.lumens, luminaire.beam_angle_rad, luminaire.field_angle_rad);
    }
  } else if (!ies) {
    if (lumens) luminaire.intensity = make_isotropic(luminaire.lumens);
  } else if (const auto path = read_file(s, "file")) {
    luminaire.ies_path = *path;
    const Checked<IesFile> file = load_ies(*path);
    if (!file) {
      problems.add(s.place_of("file"), fmt::format("{} cannot be used", in_quotes(path->filename().string())),
                   "mend what is listed for it, or use another file");
      for (const Problem& problem : file.error()) problems.add(problem);
      return;
    }
    for (const std::string& warning : file->warnings) {
      rig.notes.push_back({path->string(), 0, 0, warning, "check the file against the maker's data sheet"});
    }
    Intensity intensity = make_intensity(*file);
    const double flux_lm = intensity->flux_lm();
    if (!(flux_lm > 0) || !std::isfinite(flux_lm)) {
      problems.add(s.place_of("file"), fmt::format("{} sends out no light", in_quotes(path->filename().string())),
                   "use a file whose candela values are not all zero");
      return;
    }
    luminaire.intensity = lumens ? scaled_to_flux(std::move(intensity), luminaire.lumens) : std::move(intensity);
    if (!lumens && !s.has("lumens")) luminaire.lumens = flux_lm;
  }
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
