#pragma once
/// Strokes on the patches of a scene → the lux wanted at each of them.

#include "core/goals/seed_regions.h"
#include "core/goals/stroke.h"

namespace luxrig {

/// The lux of a patch follows from the strokes in force, in their order, and from nothing else: undoing, doing again
/// and erasing leave the same bits as painting afresh what remains. Only what a stroke covers is worked out again, in
/// time linear in that (but a brush's patches are sorted).
class Painting {
 public:
  Painting(const SurfacePatches& surface, const RayScene& rays);  ///< both must outlive this

  /// Puts a stroke on top, and forgets what was undone. A stroke that meets no surface, or whose numbers are not as
  /// stroke.h says, joins the list and changes nothing else.
  void add(const Stroke& stroke);
  /// The brush at the end of the list goes on, and what was undone is forgotten. Nothing happens if no brush is there.
  void extend(const SurfacePlace& place);
  /// False if there is nothing to undo or to do again.
  bool undo();
  bool redo();

  /// The document: all strokes that are not undone.
  [[nodiscard]] std::span<const Stroke> strokes() const { return {strokes_.data(), count_}; }
  /// Lux of each patch; NaN = not painted.
  [[nodiscard]] std::span<const float> lux() const { return lux_; }
  /// Patches whose lux the last call changed.
  [[nodiscard]] std::span<const std::uint32_t> changed() const { return changed_; }
  /// The picker: lux at a place, if it is painted.
  [[nodiscard]] std::optional<double> lux_at(const SurfacePlace& place) const;

 private:
  static constexpr std::uint32_t kNone = ~0u;
  struct Covered {
    std::uint32_t patch;
    float weight;  ///< 0…1
  };
  /// What a stroke does.
  struct Layer {
    std::vector<std::uint32_t> groups;  ///< that it covers patches of, rising
    std::vector<Covered> brushed;       ///< of a brush: by rising patch
    std::uint32_t patch = kNone;        ///< of the others: where the click was
    std::uint32_t erases = kNone;       ///< the layer that an eraser takes away
    bool erased = false;
  };

  [[nodiscard]] Layer layer_of(const Stroke& stroke) const;
  [[nodiscard]] std::vector<Covered> brushed_along(const Stroke& stroke, const SurfacePlace& from,
                                                   const SurfacePlace& to) const;
  void cover(std::vector<Covered> more, Layer& layer) const;
  /// The stroke after the last in force comes in force; the last one goes.
  void put_next();
  void take_last();
  /// A layer shows, or no longer does.
  void show(std::uint32_t number);
  void hide(std::uint32_t number);
  [[nodiscard]] bool covers(std::uint32_t number, std::uint32_t patch) const;
  [[nodiscard]] std::uint32_t uppermost_at(std::uint32_t patch) const;
  void forget_undone();
  /// Works out the lux of some patches again, all of them in these groups.
  void paint_again(const std::vector<std::uint32_t>& groups, const std::vector<std::uint32_t>& patches);
  void paint_layer(std::uint32_t number, const std::vector<std::uint32_t>& patches_of_a_group);

  const SurfacePatches& surface_;
  const RayScene& rays_;
  SeedRegions regions_;
  std::vector<Stroke> strokes_;  ///< those undone are behind the count_ in force
  std::vector<Layer> layers_;    ///< one per stroke
  std::size_t count_ = 0;
  std::vector<std::vector<std::uint32_t>> layers_of_group_;  ///< rising, those in force or erased
  std::vector<float> lux_;
  std::vector<std::uint32_t> changed_;
  mutable std::vector<std::uint8_t> marked_;  ///< one per patch, all 0 between calls
};

}  // namespace luxrig
