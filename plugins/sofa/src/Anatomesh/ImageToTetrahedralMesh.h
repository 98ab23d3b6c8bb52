// The component that meshes a segmented image.
#pragma once

#include <Anatomesh/MeshOptions.h>
#include <Anatomesh/TetrahedralMeshEngine.h>
#include <Anatomesh/config.h>
#include <sofa/core/objectmodel/DataFileName.h>
#include <sofa/core/objectmodel/DataFileNameVector.h>
#include <sofa/type/Mat.h>
#include <sofa/type/Vec.h>

#include <filesystem>

#include "anatomesh/label_image.h"

namespace anatomesh::simulation {

/// File names, of which a single one may be written without brackets and quotes.
class SOFA_ANATOMESH_API ImageFileNames : public sofa::core::objectmodel::DataFileNameVector {
 public:
  using DataFileNameVector::DataFileNameVector;
  bool read(const std::string& text) override;
};

/// Meshes a label image, one or several masks in files or an array of labels, with every option of `anatomesh mesh`.
/// It works again when an input has changed and an output is read.
class SOFA_ANATOMESH_API ImageToTetrahedralMesh : public TetrahedralMeshEngine {
 public:
  SOFA_CLASS(ImageToTetrahedralMesh, TetrahedralMeshEngine);

  ImageFileNames d_filename;

  // An image of another component, in place of files.
  sofa::Data<sofa::type::Vec<3, unsigned>> d_dimensions;
  sofa::Data<sofa::type::Vec3> d_spacing;
  sofa::Data<sofa::type::Vec3> d_origin;
  sofa::Data<sofa::type::Mat3x3d> d_direction;
  sofa::Data<Values<Label>> d_voxels;

  MeshOptions options;
  sofa::core::objectmodel::DataFileName d_cacheDirectory;

 protected:
  ImageToTetrahedralMesh();

  TetMesh makeMesh() override;

 private:
  LabelImage readImage();
  LabelImage imageOfData() const;
  TetMesh meshOrCached(const LabelImage& image, const Options& asked);
  TetMesh meshImage(const LabelImage& image, const Options& asked);
};

}  // namespace anatomesh::simulation
