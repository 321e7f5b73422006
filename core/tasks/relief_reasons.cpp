#include "core/tasks/relief_reasons.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace luxrig {
namespace {

/// A service below this share is not worth a word.
constexpr double kWorthAWord = 0.1;

struct Term {
  double LightService::*share;
  double (*of)(const AimScore&);
  const char* words;
};
const Term kSeenTerms[] = {
    {&LightService::fine, [](const AimScore& s) { return s.seen ? s.seen->fine : 0; }, "fine relief"},
    {&LightService::form, [](const AimScore& s) { return s.seen ? s.seen->form : 0; }, "broad form"},
    {&LightService::lit, [](const AimScore& s) { return s.seen ? s.seen->lit_share : 0; }, "lit surface"},
    {&LightService::edge, [](const AimScore& s) { return s.seen ? s.seen->edge : 0; }, "outline"}};
const Term kThesisTerms[] = {
    {&LightService::contrast, [](const AimScore& s) { return s.local_contrast_lx; }, "local contrast"},
    {&LightService::coverage, [](const AimScore& s) { return s.coverage; }, "features with a shadow's edge"}};

std::span<const Term> terms_of(bool seen) {
  return seen ? std::span<const Term>(kSeenTerms) : std::span<const Term>(kThesisTerms);
}

std::string percent_text(double share) { return fmt::format("{:.0f} %", 100 * share); }

std::string list_text(const std::vector<std::string>& parts) {
  std::string all;
  for (std::size_t i = 0; i < parts.size(); ++i)
    all += (i == 0 ? "" : i + 1 == parts.size() ? " and " : ", ") + parts[i];
  return all;
}

/// "fine relief (100 %)" of a light, the largest shares first.
std::vector<std::string> served(const LightService& light, bool seen) {
  std::vector<Term> terms(terms_of(seen).begin(), terms_of(seen).end());
  std::stable_sort(terms.begin(), terms.end(),
                   [&](const Term& a, const Term& b) { return light.*a.share > light.*b.share; });
  std::vector<std::string> parts;
  for (const Term& term : terms)
    if (light.*term.share >= kWorthAWord)
      parts.push_back(fmt::format("{} ({})", term.words, percent_text(light.*term.share)));
  return parts;
}

std::string reached_text(const ReliefReasons& reasons) {
  const AimScore& score = reasons.score;
  std::string text;
  if (reasons.seen && score.seen) {
    const SeenScore& seen = *score.seen;
    text = fmt::format("{} of what is seen is lit and {} is burnt or black", percent_text(seen.lit_share),
                       percent_text(seen.burnt_share + seen.crushed_share));
    if (reasons.before && reasons.before->seen && reasons.before->mean_lx > 0) {
      const SeenScore& was = *reasons.before->seen;
      // The term that changed most, as a share of what it was.
      const Term* most = nullptr;
      double change = 0;
      for (const Term& term : kSeenTerms) {
        const double before = term.of(*reasons.before), by = before > 0 ? term.of(score) / before - 1 : 0;
        if (std::abs(by) > std::abs(change)) {
          most = &term;
          change = by;
        }
      }
      text += fmt::format(" ({} and {} before)", percent_text(was.lit_share),
                          percent_text(was.burnt_share + was.crushed_share));
      if (most) text += fmt::format("; most changed is {}, by {:+.0f} %", most->words, 100 * change);
    }
  } else {
    text = reasons.dimmed_to
               ? fmt::format("A limit dims these lights to {} of the levels that they were judged at: recessed",
                             percent_text(*reasons.dimmed_to))
               : "Recessed";
    text += fmt::format(
        " places differ from what is beside them by {:.1f} lx, and {} of the features have a "
        "shadow's edge",
        score.local_contrast_lx, percent_text(score.coverage));
    if (reasons.before && reasons.before->mean_lx > 0)
      text += fmt::format(" ({:.1f} lx and {} before)", reasons.before->local_contrast_lx,
                          percent_text(reasons.before->coverage));
  }
  if (score.role) {
    const std::string part = reasons.role == LightRole::any ? fmt::format("set_up {}", name_of(reasons.set_up))
                                                            : std::string(name_of(reasons.role));
    text += fmt::format("; as {} its light is {:.0f} lx on what it is for", part, score.role->wanted_lx);
    if (reasons.role == LightRole::rim) text += fmt::format(" and {:.0f} lx on the front", score.role->spared_lx);
    if (reasons.role == LightRole::background)
      text += fmt::format(" and {:.0f} lx on the object", score.role->spared_lx);
  }
  return text + ".";
}

}  // namespace

std::vector<LightService> services_of(const AimScore& score, const std::vector<LitAlone>& lights) {
  std::vector<LightService> services;
  for (const LitAlone& one : lights) services.push_back({one.light, one.level});
  for (const bool seen : {true, false})
    for (const Term& term : terms_of(seen)) {
      double all = 0;
      std::vector<double> lost;
      for (const LitAlone& one : lights) {
        lost.push_back(std::max(0.0, term.of(score) - term.of(*one.without)));
        all += lost.back();
      }
      for (std::size_t l = 0; l < lights.size(); ++l) services[l].*term.share = all > 0 ? lost[l] / all : 0;
    }
  return services;
}

std::string dark_in_words(const ReliefReasons& reasons) {
  if (reasons.dark == 0) return "";
  const std::size_t lit = static_cast<std::size_t>(std::count_if(
      reasons.lights.begin(), reasons.lights.end(), [](const LightService& light) { return light.level > 0; }));
  const std::string enough = fmt::format("{} light{} enough, {} stay{} dark: ", lit, lit == 1 ? " is" : "s are",
                                         reasons.dark, reasons.dark == 1 ? "s" : "");
  if (!reasons.gain_of_dark)
    return enough + (reasons.set_up != SetUp::none || reasons.role == LightRole::rim
                         ? "its set-up or role has no place for more"
                         : "the limits leave more of them no light");
  return enough + fmt::format("lit in the best of the ways tried, one more would change {} by {:+.4f}",
                              reasons.seen ? "what is seen" : "the objective", *reasons.gain_of_dark);
}

std::string in_two_sentences(const ReliefReasons& reasons) {
  std::vector<std::string> parts;
  for (const LightService& light : reasons.lights) {
    if (!(light.level > 0)) continue;
    const std::vector<std::string> serves = served(light, reasons.seen);
    parts.push_back(fmt::format("{} serves {}", light.light, serves.empty() ? "none of it alone" : list_text(serves)));
  }
  std::string second = parts.empty() ? "No light is lit" : list_text(parts);
  if (const std::string dark = dark_in_words(reasons); !dark.empty()) second += "; " + dark;
  std::string first = reached_text(reasons);
  return first + " " + second + ".";
}

}  // namespace luxrig
