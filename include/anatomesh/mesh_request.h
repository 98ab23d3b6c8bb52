// The options of image_to_mesh() as a user writes them, before the image is known. The command line and SOFA take them
// in these words.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "anatomesh/label_list.h"
#include "anatomesh/materials.h"
#include "anatomesh/options.h"

namespace anatomesh {

/// A value of an enumeration by its name.
template <class Enum>
using Choice = std::pair<std::string_view, Enum>;

inline constexpr std::array<Choice<Frame>, 2> kFrames = {{{"lps", Frame::lps}, {"ras", Frame::ras}}};
inline constexpr std::array<Choice<int>, 2> kOrders = {{{"1", 1}, {"2", 2}}};  // of elements
inline constexpr std::array<Choice<FidelityStage>, 2> kFidelityStages = {
    {{"final", FidelityStage::final}, {"lattice", FidelityStage::lattice}}};
inline constexpr std::array<Choice<NonConnectivity>, 4> kNonConnectivities = {{{"vertex", NonConnectivity::vertex},
                                                                               {"edge", NonConnectivity::edge},
                                                                               {"face", NonConnectivity::face},
                                                                               {"none", NonConnectivity::none}}};
inline constexpr std::array<Choice<TissueKind>, 5> kTissueKinds = {{{"brain", TissueKind::brain},
                                                                    {"ventricle", TissueKind::ventricle},
                                                                    {"tumour", TissueKind::tumour},
                                                                    {"vessel", TissueKind::vessel},
                                                                    {"other", TissueKind::other}}};

/// What is asked for.
struct MeshRequest {
  Options options;                 ///< without labels and without the materials of single tissues
  std::optional<double> fidelity;  ///< as given; else the default, or 1 within a budget of elements
  std::vector<LabelRange> ranges;
  std::map<Label, TissueKind> kinds;  ///< whose materials come from the table of the literature
  std::map<Label, double> young_modulus_pa;
  std::map<Label, double> poisson_ratio;
};

/// "lps" and so on. Each throws InvalidOption where the word is none of its table.
Frame parse_frame(std::string_view text);
int parse_order(std::string_view text);
FidelityStage parse_fidelity_stage(std::string_view text);
NonConnectivity parse_non_connectivity(std::string_view text);

// One text for one tissue; they may be called again, once a label. They throw InvalidOption.
void add_fidelity_label(MeshRequest& request, std::string_view text);  ///< "3=0.99"
void add_size_label(MeshRequest& request, std::string_view text);      ///< "3=2.5", mm
void add_tissue(MeshRequest& request, std::string_view text);          ///< "3=tumour"
void add_young(MeshRequest& request, std::string_view text);           ///< "3=9000", Pa, or "9000" for all others
void add_poisson(MeshRequest& request, std::string_view text);         ///< "3=0.45", or "0.45" for all others

/// The options with the materials of single tissues put together.
Options options_of(const MeshRequest& request);

}  // namespace anatomesh
