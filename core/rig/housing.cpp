#include "core/rig/housing.h"

namespace luxrig {

std::vector<std::size_t> housing_of(const Rig& rig, std::size_t fixture) {
  const auto first_of = [&](std::size_t f) { return rig.fixtures[f].housing.value_or(f); };
  std::vector<std::size_t> fixtures;
  for (std::size_t f = 0; f < rig.fixtures.size(); ++f)
    if (first_of(f) == first_of(fixture)) fixtures.push_back(f);
  return fixtures;
}

std::string housing_name(const Rig& rig, std::size_t fixture) {
  const Fixture& of = rig.fixtures[fixture];
  if (!of.housing) return of.name;
  const Luminaire& emitter = rig.luminaires[of.luminaire];
  // Both end in "/<emitter>".
  return of.name.substr(0, of.name.size() - (emitter.name.size() - rig.luminaires[*emitter.emitter_of].name.size()));
}

const Luminaire& housing_luminaire(const Rig& rig, std::size_t fixture) {
  const Luminaire& luminaire = rig.luminaires[rig.fixtures[fixture].luminaire];
  return rig.fixtures[fixture].housing ? rig.luminaires[*luminaire.emitter_of] : luminaire;
}

}  // namespace luxrig
