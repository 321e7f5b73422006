#include "core/goals/painting.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace luxrig {
namespace {

constexpr float kUnpainted = std::numeric_limits<float>::quiet_NaN();

bool sound(const Stroke& stroke) {
  return !stroke.path.empty() && stroke.lux >= 0 && stroke.lux <= kMaxStroke_lx && std::isfinite(stroke.radius_m) &&
         stroke.radius_m >= 0 && stroke.falloff >= 0 && stroke.falloff <= 1;
}

float over(float below_lx, const Stroke& stroke, float weight) {
  const auto lux = static_cast<float>(stroke.lux);
  return std::isnan(below_lx) || weight >= 1 ? lux : below_lx + weight * (lux - below_lx);
}

bool same_bits(float a, float b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

Painting::Painting(const SurfacePatches& surface, const RayScene& rays)
    : surface_(surface),
      rays_(rays),
      regions_(surface),
      layers_of_group_(surface.groups()),
      lux_(surface.size(), kUnpainted),
      marked_(surface.size(), 0) {}

void Painting::add(const Stroke& stroke) {
  forget_undone();
  strokes_.push_back(stroke);
  layers_.push_back(layer_of(stroke));
  put_next();
}

void Painting::extend(const SurfacePlace& place) {
  changed_.clear();
  if (count_ == 0 || strokes_[count_ - 1].kind != StrokeKind::brush) return;
  forget_undone();
  const auto number = static_cast<std::uint32_t>(count_ - 1);
  Stroke& stroke = strokes_[number];
  Layer& layer = layers_[number];
  const SurfacePlace from = stroke.path.empty() ? place : stroke.path.back();
  stroke.path.push_back(place);
  if (!sound(stroke)) return;
  std::vector<Covered> more = brushed_along(stroke, from, place);
  std::vector<std::uint32_t> patches;
  for (const Covered& covered : more) patches.push_back(covered.patch);
  const std::vector<std::uint32_t> before = layer.groups;
  cover(std::move(more), layer);
  for (const std::uint32_t group : layer.groups)
    if (!std::binary_search(before.begin(), before.end(), group)) layers_of_group_[group].push_back(number);
  paint_again(layer.groups, patches);
}

bool Painting::undo() {
  changed_.clear();
  if (count_ == 0) return false;
  take_last();
  return true;
}

bool Painting::redo() {
  changed_.clear();
  if (count_ == strokes_.size()) return false;
  put_next();
  return true;
}

std::optional<double> Painting::lux_at(const SurfacePlace& place) const {
  const auto patch = patch_at(surface_, rays_, place);
  if (!patch || std::isnan(lux_[*patch])) return {};
  return lux_[*patch];
}

void Painting::forget_undone() {
  strokes_.resize(count_);
  layers_.resize(count_);
}

Painting::Layer Painting::layer_of(const Stroke& stroke) const {
  Layer layer;
  if (!sound(stroke)) return layer;
  if (stroke.kind == StrokeKind::brush) {
    cover(brushed_along(stroke, stroke.path.front(), stroke.path.front()), layer);
    for (std::size_t i = 1; i < stroke.path.size(); ++i)
      cover(brushed_along(stroke, stroke.path[i - 1], stroke.path[i]), layer);
    return layer;
  }
  const auto patch = patch_at(surface_, rays_, stroke.path.front());
  if (!patch) return layer;
  layer.patch = *patch;
  if (stroke.kind == StrokeKind::eraser)
    layer.erases = uppermost_at(*patch);
  else
    layer.groups = {surface_.group_of_patch[*patch]};
  return layer;
}

void Painting::cover(std::vector<Covered> more, Layer& layer) const {
  for (const Covered& covered : more) {
    const std::uint32_t group = surface_.group_of_patch[covered.patch];
    const auto at = std::lower_bound(layer.groups.begin(), layer.groups.end(), group);
    if (at == layer.groups.end() || *at != group) layer.groups.insert(at, group);
  }
  std::vector<Covered> all;
  all.reserve(layer.brushed.size() + more.size());
  std::merge(layer.brushed.begin(), layer.brushed.end(), more.begin(), more.end(), std::back_inserter(all),
             [](const Covered& a, const Covered& b) { return a.patch < b.patch; });
  layer.brushed.clear();
  for (const Covered& covered : all) {
    if (!layer.brushed.empty() && layer.brushed.back().patch == covered.patch)
      layer.brushed.back().weight = std::max(layer.brushed.back().weight, covered.weight);
    else
      layer.brushed.push_back(covered);
  }
}

void Painting::put_next() {
  changed_.clear();
  const auto number = static_cast<std::uint32_t>(count_++);
  const Layer& layer = layers_[number];
  for (const std::uint32_t group : layer.groups) layers_of_group_[group].push_back(number);
  if (layer.erases != kNone)
    hide(layer.erases);
  else
    show(number);
}

void Painting::take_last() {
  const auto number = static_cast<std::uint32_t>(--count_);
  const Layer& layer = layers_[number];
  for (const std::uint32_t group : layer.groups) layers_of_group_[group].pop_back();
  if (layer.erases != kNone)
    show(layer.erases);
  else
    hide(number);
  layers_[number].erased = false;
}

void Painting::show(std::uint32_t number) {
  Layer& layer = layers_[number];
  layer.erased = false;
  std::vector<std::uint32_t> patches;
  if (strokes_[number].kind == StrokeKind::selective && layer.patch != kNone)
    regions_.add(number, layer.patch, patches);
  else if (strokes_[number].kind == StrokeKind::bucket && layer.patch != kNone)
    for (const std::uint32_t patch : surface_.patches_of_group(layer.groups.front())) patches.push_back(patch);
  for (const Covered& covered : layer.brushed) patches.push_back(covered.patch);
  paint_again(layer.groups, patches);
}

void Painting::hide(std::uint32_t number) {
  Layer& layer = layers_[number];
  layer.erased = true;
  std::vector<std::uint32_t> patches;
  if (strokes_[number].kind == StrokeKind::selective)
    regions_.remove(number, patches);
  else if (strokes_[number].kind == StrokeKind::bucket && layer.patch != kNone)
    for (const std::uint32_t patch : surface_.patches_of_group(layer.groups.front())) patches.push_back(patch);
  for (const Covered& covered : layer.brushed) patches.push_back(covered.patch);
  paint_again(layer.groups, patches);
}

bool Painting::covers(std::uint32_t number, std::uint32_t patch) const {
  const Layer& layer = layers_[number];
  switch (strokes_[number].kind) {
    case StrokeKind::bucket:
      return layer.groups.front() == surface_.group_of_patch[patch];
    case StrokeKind::selective:
      return regions_.owner(patch) == number;
    case StrokeKind::eraser:
      return false;
    case StrokeKind::brush:
      break;
  }
  const auto at = std::lower_bound(layer.brushed.begin(), layer.brushed.end(), patch,
                                   [](const Covered& covered, std::uint32_t p) { return covered.patch < p; });
  return at != layer.brushed.end() && at->patch == patch;
}

std::uint32_t Painting::uppermost_at(std::uint32_t patch) const {
  const std::vector<std::uint32_t>& layers = layers_of_group_[surface_.group_of_patch[patch]];
  for (auto number = layers.rbegin(); number != layers.rend(); ++number)
    if (!layers_[*number].erased && covers(*number, patch)) return *number;
  return kNone;
}

void Painting::paint_again(const std::vector<std::uint32_t>& groups, const std::vector<std::uint32_t>& patches) {
  std::vector<std::uint32_t> of_group;
  std::vector<float> before_lx;
  for (const std::uint32_t group : groups) {
    of_group.clear();
    before_lx.clear();
    for (const std::uint32_t patch : patches) {
      if (marked_[patch] || surface_.group_of_patch[patch] != group) continue;
      marked_[patch] = 1;
      of_group.push_back(patch);
      before_lx.push_back(lux_[patch]);
      lux_[patch] = kUnpainted;
    }
    // Nothing shows through the last bucket.
    const std::vector<std::uint32_t>& layers = layers_of_group_[group];
    std::size_t lowest = layers.size();
    while (lowest > 0) {
      const std::uint32_t number = layers[--lowest];
      if (strokes_[number].kind == StrokeKind::bucket && !layers_[number].erased) break;
    }
    for (; lowest < layers.size(); ++lowest)
      if (!layers_[layers[lowest]].erased) paint_layer(layers[lowest], of_group);
    for (std::size_t i = 0; i < of_group.size(); ++i) {
      marked_[of_group[i]] = 0;
      if (!same_bits(lux_[of_group[i]], before_lx[i])) changed_.push_back(of_group[i]);
    }
  }
}

void Painting::paint_layer(std::uint32_t number, const std::vector<std::uint32_t>& patches_of_a_group) {
  const Stroke& stroke = strokes_[number];
  if (stroke.kind == StrokeKind::brush) {
    for (const Covered& covered : layers_[number].brushed)
      if (marked_[covered.patch]) lux_[covered.patch] = over(lux_[covered.patch], stroke, covered.weight);
    return;
  }
  for (const std::uint32_t patch : patches_of_a_group)
    if (stroke.kind == StrokeKind::bucket || regions_.owner(patch) == number)
      lux_[patch] = static_cast<float>(stroke.lux);
}

}  // namespace luxrig
