#pragma once
/// `luxrig render --show`: pictures of why lights are where they are. One function per kind, each in a file of its
/// kind; the first three are of the object's surface.

#include "core/highlight/picture/object_view.h"
#include "core/highlight/surface/relief_study.h"
#include "tools/luxrig/render/render_command.h"
#include "tools/terminal/figure_png.h"

namespace luxrig {

/// A rig in its scene, its lights hung and turned as the plan says if there is one.
struct ShownRig {
  Rig rig;
  Scene scene;
  std::vector<double> levels;  ///< per fixture
};

/// One of its objects, and all that its lights would be chosen from.
struct ShownObject {
  std::string name;
  Scene target;  ///< the object alone
  Scene rest;    ///< everything else
  ReliefStudy study;
  Vec3 towards_viewer;  ///< unit; the side that the rig's points are on, or its lamps
};

/// The picture without its title. Refusals say what would mend them.
[[nodiscard]] Result<Figure> curvature_figure(const ShownObject& object, const RenderOptions& options);
[[nodiscard]] Result<Figure> interest_figure(const ShownObject& object, const RenderOptions& options);
[[nodiscard]] Result<Figure> feature_figure(const ShownObject& object, const RenderOptions& options);
[[nodiscard]] Result<Figure> histogram_figure(const ShownRig& rig, const ShownObject& object,
                                              const RenderOptions& options);
[[nodiscard]] Result<Figure> domain_figure(const ShownRig& rig, const ShownObject& object,
                                           const RenderOptions& options);
[[nodiscard]] Result<Figure> beam_figure(const ShownRig& rig, const RenderOptions& options);

/// The object whose relief is shown: the one asked for, else the only one from a mesh file. Refuses when there is none
/// or more than one, naming them.
[[nodiscard]] Result<std::string> object_to_show(const Rig& rig, const std::optional<std::string>& wanted);

/// As the options say, else as chosen; near_m is 0 where the eye is the caller's.
[[nodiscard]] CutAwayCamera as_asked(CutAwayCamera chosen, const RenderOptions& options);

/// Grey by how squarely the surface faces the eye, 0.55…1 times the colour.
[[nodiscard]] Vec3f shaded(const Vec3& rgb, const Vec3& normal, const Vec3& towards_eye);

/// Shadow edges of the object, with a line of progress.
[[nodiscard]] Result<ShadowEdges> shown_shadow_edges(const ShownObject& object, const RenderOptions& options);

/// What a person reads of how the relief was found: its scale, and how many interest points.
[[nodiscard]] std::string relief_words(const ReliefStudy& study);

constexpr double kShowFov_deg = 30;  ///< where none is asked for: an object is not drawn out of shape
constexpr int kShowSamplesPerEdge = 3;

}  // namespace luxrig
