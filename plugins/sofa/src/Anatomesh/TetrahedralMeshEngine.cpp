#include <Anatomesh/MeshOptions.h>
#include <Anatomesh/TetrahedralMeshEngine.h>

#include <exception>
#include <map>
#include <set>

#include "anatomesh/errors.h"
#include "anatomesh/image_to_mesh.h"
#include "anatomesh/interfaces.h"

namespace anatomesh::simulation {
namespace {

using sofa::core::objectmodel::ComponentState;
using sofa::helper::getWriteOnlyAccessor;
using Triangle = TetrahedralMeshEngine::Triangle;

Triangle triangle_of(const TetMesh& mesh, TetFace face) {
  const auto corners = corners_of(mesh, face);
  return {corners[0], corners[1], corners[2]};
}

}  // namespace

TetrahedralMeshEngine::TetrahedralMeshEngine()
    : d_tissue(initData(&d_tissue, "tissue", "materials by kind: LABEL=brain|ventricle|tumour|vessel|other")),
      d_young(initData(&d_young, "young", "Young's moduli, Pa: LABEL=PA, or PA for all others [3000]")),
      d_poisson(initData(&d_poisson, "poisson", "Poisson ratios: LABEL=NU, or NU for all others [0.45]")),
      d_position(initData(&d_position, "position", "vertices of the mesh, mm")),
      d_tetrahedra(initData(&d_tetrahedra, "tetrahedra", "tetrahedra of the mesh, positively oriented")),
      d_label(initData(&d_label, "label", "label of each tetrahedron")),
      d_triangles(initData(&d_triangles, "triangles", "outer surface, seen anticlockwise from outside")),
      d_surfacePoints(initData(&d_surfacePoints, "surfacePoints", "vertices of the outer surface, ascending")),
      d_interfaceTriangles(
          initData(&d_interfaceTriangles, "interfaceTriangles", "faces between two tissues, one pair after the other")),
      d_interfaceLabels(initData(&d_interfaceLabels, "interfaceLabels", "the two labels of each interface triangle")),
      d_tissueLabels(initData(&d_tissueLabels, "tissueLabels", "labels of the mesh, ascending")),
      d_tetrahedraInLabel(
          initData(&d_tetrahedraInLabel, "tetrahedraInLabel", "tetrahedra of each of tissueLabels, ascending")),
      d_youngModulus(initData(&d_youngModulus, "youngModulus", "Young's modulus of each tetrahedron, Pa")),
      d_poissonRatio(initData(&d_poissonRatio, "poissonRatio", "Poisson ratio of each tetrahedron")) {
  for (sofa::core::BaseData* input : std::initializer_list<sofa::core::BaseData*>{&d_tissue, &d_young, &d_poisson})
    addInput(input);
  for (sofa::core::BaseData* output : std::initializer_list<sofa::core::BaseData*>{
           &d_position, &d_tetrahedra, &d_label, &d_triangles, &d_surfacePoints, &d_interfaceTriangles,
           &d_interfaceLabels, &d_tissueLabels, &d_tetrahedraInLabel, &d_youngModulus, &d_poissonRatio}) {
    addOutput(output);
    output->setReadOnly(true);
  }
}

void TetrahedralMeshEngine::init() { updateIfDirty(); }

void TetrahedralMeshEngine::reinit() { updateIfDirty(); }

void TetrahedralMeshEngine::doUpdate() {
  const auto fail = [this](const std::string& sentence) {
    msg_error() << sentence;
    setMesh({});
    d_componentState.setValue(ComponentState::Invalid);
  };
  try {
    setMesh(makeMesh());
    d_componentState.setValue(ComponentState::Valid);
  } catch (const Error& error) {
    fail(with_data_names(error.what()));
  } catch (const std::bad_alloc&) {
    fail("memory ran out; a larger bccSize or minSize, or fewer labels, needs less");
  } catch (const std::exception& error) {
    fail(std::string("unexpected: ").append(error.what()));
  }
}

void TetrahedralMeshEngine::addMaterials(MeshRequest& request) const {
  add_each(d_tissue, request, add_tissue);
  add_each(d_young, request, add_young);
  add_each(d_poisson, request, add_poisson);
}

void TetrahedralMeshEngine::setMesh(const TetMesh& mesh) {
  setMaterials(mesh);  // the only one that throws, before anything has changed
  auto position = getWriteOnlyAccessor(d_position);
  position.clear();
  for (const Vec3& p : mesh.points_mm) position.push_back({p.x, p.y, p.z});
  auto tetrahedra = getWriteOnlyAccessor(d_tetrahedra);
  tetrahedra.clear();
  for (const auto& t : mesh.tets) tetrahedra.push_back({t[0], t[1], t[2], t[3]});
  getWriteOnlyAccessor(d_label).wref().assign(mesh.labels.begin(), mesh.labels.end());
  setSurfaces(mesh);
  setTissues(mesh);
}

void TetrahedralMeshEngine::setSurfaces(const TetMesh& mesh) {
  auto skin = getWriteOnlyAccessor(d_triangles);
  auto between = getWriteOnlyAccessor(d_interfaceTriangles);
  auto labels = getWriteOnlyAccessor(d_interfaceLabels);
  skin.clear(), between.clear(), labels.clear();
  std::set<VertexId> points;
  for (const Interface& interface : interfaces_of(mesh)) {
    for (const TetFace face : interface.faces) {
      const Triangle triangle = triangle_of(mesh, face);
      if (interface.outside == 0) {
        skin.push_back(triangle);
        points.insert(triangle.begin(), triangle.end());
      } else {
        between.push_back(triangle);
        labels.push_back({interface.inside, interface.outside});
      }
    }
  }
  getWriteOnlyAccessor(d_surfacePoints).wref().assign(points.begin(), points.end());
}

void TetrahedralMeshEngine::setTissues(const TetMesh& mesh) {
  std::map<Label, sofa::type::SVector<Index>> tets;
  for (std::size_t t = 0; t < mesh.labels.size(); ++t) tets[mesh.labels[t]].push_back(static_cast<Index>(t));
  auto labels = getWriteOnlyAccessor(d_tissueLabels);
  auto sets = getWriteOnlyAccessor(d_tetrahedraInLabel);
  labels.clear(), sets.clear();
  for (const auto& [label, indices] : tets) {
    labels.push_back(label);
    sets.push_back(indices);
  }
}

void TetrahedralMeshEngine::setMaterials(const TetMesh& mesh) {
  MeshRequest request;
  if (!mesh.tets.empty()) addMaterials(request);
  const Options options = options_of(request);
  check_options(options);
  auto young = getWriteOnlyAccessor(d_youngModulus);
  auto poisson = getWriteOnlyAccessor(d_poissonRatio);
  young.clear(), poisson.clear();
  for (const Label label : mesh.labels) {
    const auto own = options.deform.material.find(label);
    const Material& material = own == options.deform.material.end() ? options.deform.default_material : own->second;
    young.push_back(material.young_modulus_pa);
    poisson.push_back(material.poisson_ratio);
  }
}

}  // namespace anatomesh::simulation
