#pragma once
/// What is seen of an object in the rig's scene, and the light that the room throws back on it, for relief tasks.

#include <memory>
#include <span>
#include <vector>

#include "core/highlight/aim/hanging_head.h"
#include "core/highlight/seen/seen_contrast.h"
#include "core/tasks/light_role.h"
#include "core/tasks/relief_task.h"

namespace luxrig {

/// `quick` is a coarser picture of the same, for searches.
struct SeenObject {
  std::shared_ptr<const SeenContrast> fine, quick;
  std::vector<float> fixed_lux, quick_fixed_lux;  ///< light that stays, at their samples
  AskedOfLight asked, quick_asked;                ///< by the task's role and set-up
  LightWindow window;
};

/// From the task's camera; without one from where most of the relief is in sight, and 40° to either side of it. What
/// stands before the object is left out where it hides it altogether.
/// fixed_lux   light that stays, at the object's samples
/// Refuses as asked_of_light.
[[nodiscard]] Result<SeenObject> seen_object(const ReliefSurroundings& around, const StudiedObject& object,
                                             const ReliefSpec& relief, std::span<const double> fixed_lux,
                                             const ComputeOptions& options);

/// Where aims are judged: at the object's relief; for rim and background, at what they shall light, with the object's limit
/// left to AimWishes::limits.
struct LitPlaces {
  const ContrastSamples* samples = nullptr;
  const FeatureClusters* features = nullptr;
  std::unique_ptr<WantedPlaces> own;
};
[[nodiscard]] LitPlaces lit_places(const StudiedObject& object, const ReliefSpec& relief, const SeenObject* seen,
                                   AimWishes& wishes);

/// Mean light on the object by way of the room from each head at full level, aimed at the object's middle [lx].
[[nodiscard]] Result<std::vector<double>> reflected_lx_of(const ReliefSurroundings& around, const StudiedObject& object,
                                                          std::span<const HangingHead> heads,
                                                          const ComputeOptions& options);

/// Makes the aim's wishes those of what is seen and of the task's role, and gives the heads their reflected light.
[[nodiscard]] Result<void> wish_what_is_seen(const ReliefSurroundings& around, const StudiedObject& object,
                                             const SeenObject& seen, std::span<HangingHead> heads, AimWishes& wishes,
                                             const ComputeOptions& options);

}  // namespace luxrig
