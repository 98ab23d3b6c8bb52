"""brain.scn for SofaPython3: a brain with ventricles and a tumour under gravity, held by the skull.

Units: mm, g, s, and so Pa = g / (mm s^2).
"""

PLUGINS = (
    "Anatomesh",
    "Sofa.Component.Constraint.Projective",
    "Sofa.Component.LinearSolver.Iterative",
    "Sofa.Component.Mass",
    "Sofa.Component.ODESolver.Backward",
    "Sofa.Component.SolidMechanics.FEM.Elastic",
    "Sofa.Component.StateContainer",
    "Sofa.Component.Topology.Container.Dynamic",
    "Sofa.Component.Visual",
)


def createScene(root):
    root.dt = 0.02
    root.gravity = [0, 9810, 0]
    for plugin in PLUGINS:
        root.addObject("RequiredPlugin", name=plugin)
    root.addObject("DefaultAnimationLoop")
    root.addObject("VisualStyle", displayFlags="showForceFields")

    brain = root.addChild("brain")
    brain.addObject(
        "ImageToTetrahedralMesh", name="mesher", printLog="true", filename="brain.nii.gz", maxElements="15000",
        tissue="1=brain 3=tumour", young="2=500", poisson="2=0.45")
    brain.addObject("EulerImplicitSolver", rayleighStiffness="0.05", rayleighMass="0.5")
    brain.addObject("CGLinearSolver", name="cg", iterations="500", tolerance="1e-6", threshold="1e-12")
    brain.addObject(
        "TetrahedronSetTopologyContainer", name="topology", position="@mesher.position",
        tetrahedra="@mesher.tetrahedra")
    brain.addObject("TetrahedronSetTopologyModifier")
    brain.addObject("TetrahedronSetGeometryAlgorithms", template="Vec3")
    brain.addObject("MechanicalObject", name="state", template="Vec3")
    brain.addObject("DiagonalMass", massDensity="1.04e-3")
    brain.addObject(
        "TetrahedronFEMForceField", name="fem", method="large", drawHeterogeneousTetra="true",
        youngModulus="@mesher.youngModulus", poissonRatio="@mesher.poissonRatio")
    brain.addObject("FixedProjectiveConstraint", name="skull", indices="@mesher.surfacePoints")
