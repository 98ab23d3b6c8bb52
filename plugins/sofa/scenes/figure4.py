"""figure4.scn for SofaPython3: a segmented image becomes a soft body, its tetrahedra a visual model.

Units: mm, g, s, and so Pa = g / (mm s^2).
"""

PLUGINS = (
    "Anatomesh",
    "Sofa.Component.Constraint.Projective",
    "Sofa.Component.Engine.Select",
    "Sofa.Component.LinearSolver.Iterative",
    "Sofa.Component.Mapping.Linear",
    "Sofa.Component.Mass",
    "Sofa.Component.ODESolver.Backward",
    "Sofa.Component.SolidMechanics.FEM.Elastic",
    "Sofa.Component.StateContainer",
    "Sofa.Component.Topology.Container.Dynamic",
    "Sofa.Component.Topology.Mapping",
    "Sofa.Component.Visual",
)


def createScene(root):
    root.dt = 0.02
    root.gravity = [0, 0, -9810]
    for plugin in PLUGINS:
        root.addObject("RequiredPlugin", name=plugin)
    root.addObject("DefaultAnimationLoop")
    root.addObject("VisualStyle", displayFlags="showVisualModels hideBehaviorModels")

    tissue = root.addChild("tissue")
    tissue.addObject(
        "ImageToTetrahedralMesh", name="mesher", printLog="true", filename="malformation.nii.gz",
        young="30000 2=300000")
    tissue.addObject("EulerImplicitSolver", rayleighStiffness="0.05", rayleighMass="0.1")
    tissue.addObject("CGLinearSolver", iterations="200", tolerance="1e-6", threshold="1e-12")
    tissue.addObject(
        "TetrahedronSetTopologyContainer", name="topology", position="@mesher.position",
        tetrahedra="@mesher.tetrahedra")
    tissue.addObject("TetrahedronSetTopologyModifier")
    tissue.addObject("TetrahedronSetGeometryAlgorithms", template="Vec3")
    tissue.addObject("MechanicalObject", name="state", template="Vec3")
    tissue.addObject("DiagonalMass", massDensity="1.04e-3")
    tissue.addObject(
        "TetrahedronFEMForceField", name="fem", method="large", youngModulus="@mesher.youngModulus",
        poissonRatio="@mesher.poissonRatio")
    tissue.addObject("BoxROI", name="table", box="0 0 0 64 64 10", position="@mesher.position")
    tissue.addObject("FixedProjectiveConstraint", indices="@table.indices")

    surface = tissue.addChild("surface")
    surface.addObject("TriangleSetTopologyContainer", name="triangles")
    surface.addObject("TriangleSetTopologyModifier")
    surface.addObject("Tetra2TriangleTopologicalMapping", input="@../topology", output="@triangles")
    surface.addObject("VisualModel", name="visual", color="0.85 0.55 0.5 1")
    surface.addObject("IdentityMapping", input="@../state", output="@visual")
