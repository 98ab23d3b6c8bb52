// Segments of a 3D Slicer segmentation, a NRRD file (.seg.nrrd) whose keys describe what its voxels mean.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "anatomesh/label_table.h"

namespace anatomesh {

/// One segment: the voxels of a value in a layer. Layers are label images of one grid.
struct Segment {
  LabelEntry entry;
  std::size_t layer = 0;
  Label value = 1;  ///< in its layer
  Label label = 1;  ///< in the one image that is made of all layers
};

/// Segments and what to tell the user about them.
struct SegmentList {
  std::vector<Segment> segments;  ///< in the order of the file; empty: the file is no segmentation
  std::vector<std::string> notes;

  LabelTable names() const;
};

/// The segments that the keys of a file of so many layers describe. They keep their values as labels where all are
/// different, else they are numbered from 1. Throws InvalidInput: a layer that is not there, a value that is none, two
/// segments of one value in one layer.
SegmentList segments_of(const std::filesystem::path& path, const std::map<std::string, std::string>& keys,
                        std::size_t layers);

/// Puts the layers of an image into one, voxel by voxel; the later segment wins.
class LayerMerger {
 public:
  LayerMerger(const std::vector<Segment>& segments, std::size_t layers);

  /// values: the layers of each voxel side by side.
  void merge(const Label* values, std::size_t voxels, Label* labels);

  /// Sentences about voxels of several segments, and of values that no segment has.
  std::vector<std::string> notes(const std::filesystem::path& path) const;

 private:
  std::vector<std::map<Label, std::size_t>> segment_of_value_;  ///< one map a layer
  std::vector<Label> labels_;                                   ///< one a segment
  std::uint64_t overlapping_voxels_ = 0, unknown_voxels_ = 0;
};

}  // namespace anatomesh
