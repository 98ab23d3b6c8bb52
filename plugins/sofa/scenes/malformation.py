"""malformation.scn for SofaPython3: a tool pulls a vessel malformation out of a block of brain.

Units: mm, g, s, and so Pa = g / (mm s^2).
"""

PLUGINS = (
    "Anatomesh",
    "Sofa.Component.Constraint.Projective",
    "Sofa.Component.Engine.Select",
    "Sofa.Component.LinearSolver.Iterative",
    "Sofa.Component.Mass",
    "Sofa.Component.ODESolver.Backward",
    "Sofa.Component.SolidMechanics.FEM.Elastic",
    "Sofa.Component.StateContainer",
    "Sofa.Component.Topology.Container.Dynamic",
    "Sofa.Component.Visual",
)


def createScene(root):
    root.dt = 0.01
    root.gravity = [0, 0, 0]
    for plugin in PLUGINS:
        root.addObject("RequiredPlugin", name=plugin)
    root.addObject("DefaultAnimationLoop")
    root.addObject("VisualStyle", displayFlags="showForceFields showBehaviorModels")

    malformation = root.addChild("malformation")
    malformation.addObject(
        "ImageToTetrahedralMesh", name="mesher", printLog="true", filename="malformation.nii.gz", elementsAcross="1",
        young="3000 2=30000", poisson="0.45")
    malformation.addObject("EulerImplicitSolver", rayleighStiffness="0.05", rayleighMass="0.1")
    malformation.addObject("CGLinearSolver", iterations="200", tolerance="1e-6", threshold="1e-12")
    malformation.addObject(
        "TetrahedronSetTopologyContainer", name="topology", position="@mesher.position",
        tetrahedra="@mesher.tetrahedra")
    malformation.addObject("TetrahedronSetTopologyModifier")
    malformation.addObject("TetrahedronSetGeometryAlgorithms", template="Vec3")
    malformation.addObject("MechanicalObject", name="state", template="Vec3")
    malformation.addObject("DiagonalMass", massDensity="1.04e-3")
    malformation.addObject(
        "TetrahedronFEMForceField", name="fem", method="large", drawHeterogeneousTetra="true",
        youngModulus="@mesher.youngModulus", poissonRatio="@mesher.poissonRatio")
    malformation.addObject("BoxROI", name="base", box="0 0 0 64 64 12", position="@mesher.position", drawBoxes="true")
    malformation.addObject("FixedProjectiveConstraint", indices="@base.indices")
    malformation.addObject(
        "BoxROI", name="grip", box="22 22 48 42 42 60", position="@mesher.position", drawBoxes="true")
    malformation.addObject(
        "LinearMovementProjectiveConstraint", name="tool", template="Vec3", indices="@grip.indices",
        keyTimes="0 1 1000", movements="0 0 0  0 0 5  0 0 5")
