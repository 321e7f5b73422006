#pragma once
/// `luxrig render --show`: pictures that explain why lights are where they are. One function per kind, each in its own
/// file; the first three show the object's surface.

#include "core/highlight/picture/object_view.h"
#include "core/highlight/surface/relief_study.h"
#include "tools/luxrig/render/render_command.h"
#include "tools/terminal/figure_png.h"

namespace luxrig {

/// A rig in its scene, and its look. If there is a plan, its lights are hung.
struct ShownRig {
  Rig rig;
  Scene scene;
  Look look;
};

/// One object of it, with everything that its lights would be chosen from.
struct ShownObject {
  std::string name;
  Scene target;  ///< the object alone
  Scene rest;    ///< everything else
  ReliefStudy study;
  Vec3 towards_viewer;  ///< unit; the side of the rig's points, else of its lamps
};

/// The picture without its title. A refusal says what would mend it.
[[nodiscard]] Result<Figure> curvature_figure(const ShownObject& object, const RenderOptions& options);
[[nodiscard]] Result<Figure> interest_figure(const ShownObject& object, const RenderOptions& options);
[[nodiscard]] Result<Figure> feature_figure(const ShownObject& object, const RenderOptions& options);
[[nodiscard]] Result<Figure> histogram_figure(const ShownRig& rig, const ShownObject& object,
                                              const RenderOptions& options);
[[nodiscard]] Result<Figure> domain_figure(const ShownRig& rig, const ShownObject& object,
                                           const RenderOptions& options);
[[nodiscard]] Result<Figure> beam_figure(const ShownRig& rig, const RenderOptions& options);

/// The object with the relief: the one asked for, else the only one from a mesh file. Refuses if there is none or more
/// than one, and names them.
[[nodiscard]] Result<std::string> object_to_show(const Rig& rig, const std::optional<std::string>& wanted);

/// As the options say, else as chosen. near_m is 0 if the caller sets the eye.
[[nodiscard]] CutAwayCamera as_asked(CutAwayCamera chosen, const RenderOptions& options);

/// Grey by how squarely the surface faces the eye, 0.55…1 times the colour.
[[nodiscard]] Vec3f shaded(const Vec3& rgb, const Vec3& normal, const Vec3& towards_eye);

/// Shadow edges of the object, with a progress line.
[[nodiscard]] Result<ShadowEdges> shown_shadow_edges(const ShownObject& object, const RenderOptions& options);

/// How the relief was found, for a person: its scale and the number of interest points.
[[nodiscard]] std::string relief_words(const ReliefStudy& study);

constexpr double kShowFov_deg = 30;  ///< default: narrow, so that an object is not distorted
constexpr int kShowSamplesPerEdge = 3;

}  // namespace luxrig
