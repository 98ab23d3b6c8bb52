// Files: segmented images in, meshes in and out.
//
// Every message of these functions is one sentence that names the file, the value at fault and what
// would be right. None of them prints: what ITK and VTK have to say becomes a note or an error. Calls
// into ITK and VTK take turns, since both report through one place a process. While a MetaImage file is
// read, whose library prints on its own, the process's standard error is muted. HDF5, MINC and DICOM series
// are read in a forked child, since their libraries crash on some damaged files.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "anatomesh/label_image.h"
#include "anatomesh/label_table.h"
#include "anatomesh/tet_mesh.h"

namespace anatomesh {

/// A segmented image as read from a file.
struct ImageFile {
  LabelImage image;
  std::vector<std::string> notes;  ///< sentences for the user, e.g. which of two NIfTI geometries was used
};

/// Reads a 3D label image: NIfTI, Analyze, NRRD, MetaImage, MINC, FreeSurfer's MGH, a binary DICOM segmentation object,
/// or a folder with one DICOM series.
/// Voxels may be integers of 8 to 64 bits, or floats that are all integral; labels from 0 to 2^32 - 1
/// are kept exactly. Trailing dimensions of size 1 are dropped.
/// NIfTI: the sform where its code is > 0 and it is a rotation (possibly with a reflection) times the
/// spacing, else the qform, with the spacing of that form; other units than mm are converted.
/// Segmentations of 3D Slicer (NRRD with its keys) and in DICOM come with names; where their segments overlap the later
/// one wins, and a note says in how many voxels. DICOM slices must be evenly spaced. Analyze files and NIfTI files with
/// neither form do not say where they lie: their axes are taken as LPS, their origin as 0. Memory: the labels, plus up
/// to two copies of the voxels in the type of the file (none for NIfTI files of 32-bit voxels); DICOM series and MINC:
/// the labels once more. Speed: that of zlib.
/// Throws IoError (missing, unreadable, truncated) or InvalidInput (readable, but no such label image).
ImageFile read_label_image(const std::filesystem::path& path);

/// Reads masks of one grid, images with one value beside 0 each, into one image: the first mask is labelled 1, the
/// second 2, and so on; where masks overlap the later one wins, and a note says in how many voxels. Names are those of
/// the files without their extension. Memory: as read_label_image(), and the labels once more.
/// Throws as read_label_image(), and InvalidInput (no mask, grids that differ, a mask of several values).
ImageFile read_label_masks(const std::vector<std::filesystem::path>& paths);

/// Reads names and colours of labels: a colour table of 3D Slicer, a lookup table of FreeSurfer, a label description of
/// ITK-SNAP, or comma- or tab-separated text (label,name[,red,green,blue], or with titles of columns). Recognised by
/// content. Throws IoError (missing, unreadable) or InvalidInput, which names the line.
LabelTable read_label_table(const std::filesystem::path& path);

/// Writes a label image in the format of the extension (.nii, .nii.gz, .nrrd, .mha, .mnc) with the
/// smallest unsigned integers that hold its labels. Whole or nothing.
/// Throws IoError, InvalidInput (unknown extension, or a format that cannot hold the image).
void write_label_image(const std::filesystem::path& path, const LabelImage& image);

/// Extensions that write_mesh() knows, with their dot, the default first: docs/formats.md.
std::vector<std::string> mesh_extensions();

/// Writes a mesh in the format of the extension, whole or nothing. About 1 s for 1.2 million tetrahedra.
/// Throws IoError, InvalidInput (unknown extension, not one label a tetrahedron, or a label that the format
/// cannot hold).
void write_mesh(const std::filesystem::path& path, const TetMesh& mesh);

/// Reads the linear tetrahedra of a file of any tool, in the order and orientation of the file, in any format
/// that write_mesh() knows but those of surfaces. Labels of VTK files come from the cell array "label", else
/// from one of the names other tools use ("labels", "medit:ref", "gmsh:physical", "material", ...), else from
/// the first integral cell array that is no list of ids; without any, all labels are 1. Other formats: their
/// groups, sets, references or properties.
/// Throws IoError (missing, unreadable, truncated, damaged) or InvalidInput (no tetrahedra, labels that
/// are not whole numbers from 0 to 2^32 - 1).
TetMesh read_mesh(const std::filesystem::path& path);

/// Writes the closed surface of each tissue into a file of its own, STL, PLY, OBJ or VTP by the extension:
/// "brain.stl" becomes "brain_Liver.stl", or "brain_label_7.stl" where the label has no name. All of them or
/// none. Returns their paths, by ascending label.
/// Throws IoError, InvalidInput (unknown extension, or not one label a tetrahedron).
std::vector<std::filesystem::path> write_tissue_surfaces(const std::filesystem::path& path, const TetMesh& mesh);

/// Throws IoError unless a file can be written there: its folder exists and is writable, and it is not
/// itself a folder. Meant to be called before the long work starts. Any extension will do.
void check_writable(const std::filesystem::path& path);

/// As check_writable(), and throws InvalidInput unless write_mesh() knows the extension.
void check_mesh_writable(const std::filesystem::path& path);

/// As check_writable(), and throws InvalidInput unless write_tissue_surfaces() knows the extension.
void check_tissue_surfaces_writable(const std::filesystem::path& path);

/// Writes a text file, whole or nothing: an earlier file stays as it is unless all of the new one could
/// be written. Something there that is neither file nor folder (a pipe, /dev/stdout) is written to as it
/// is. Throws IoError.
void write_text_file(const std::filesystem::path& path, std::string_view text);

}  // namespace anatomesh
