#include "core/transport/rig_transport.h"

namespace luxrig {

std::vector<Emitter> emitters_of(const Rig& rig) {
  std::vector<Emitter> emitters;
  emitters.reserve(rig.fixtures.size());
  for (const Fixture& fixture : rig.fixtures)
    emitters.push_back({rig.luminaires.at(fixture.luminaire).intensity, fixture.world_from_lamp()});
  return emitters;
}

std::vector<Receiver> receivers_of(const Rig& rig) {
  std::vector<Receiver> receivers;
  receivers.reserve(rig.points.size() + rig.luxmeters.size());
  for (const Point& point : rig.points) receivers.push_back({point.position_world_m, point.normal_world});
  for (const Luxmeter& meter : rig.luxmeters) receivers.push_back({meter.position_world_m, meter.normal_world});
  return receivers;
}

}  // namespace luxrig
