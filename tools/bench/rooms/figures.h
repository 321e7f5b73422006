#pragma once
/// Detailed objects for the rooms.

#include "tools/bench/rooms/solid_model.h"

namespace luxrig {

/// A robed figure on base_m with one arm raised, about 1.05 · height_m high in total.
void add_statue(SolidModel& model, const Vec3& base_m, double height_m, double turn_rad, double cell_m,
                SolidModel::MaterialIndex material);

/// A fluted vase of 60 · 29 faces.
void add_vase(SolidModel& model, const Vec3& base_m, double height_m, SolidModel::MaterialIndex material, int flutes);

/// A crown of leaves with `segments` around it: height_m high, width_m wide.
void add_crown(SolidModel& model, const Vec3& base_m, double width_m, double height_m, int segments,
               SolidModel::MaterialIndex material);

}  // namespace luxrig
