"""ParaView opens the XDMF sidecar with each of its readers: the cloth, and a static mesh. usage: check_paraview.py FOLDER"""
import pathlib
import sys

from paraview import servermanager, simple


def leaves(data):
    if data is None or not data.IsA("vtkCompositeDataSet"):
        return [data]
    found, at = [], data.NewIterator()
    while not at.IsDoneWithTraversal():
        found += leaves(at.GetCurrentDataObject())
        at.GoToNextItem()
    return found


path = str(next(pathlib.Path(sys.argv[1]).glob("*.xdmf")))
for reader in (lambda: simple.XDMFReader(FileNames=[path]), lambda: simple.Xdmf3ReaderS(FileName=[path]), lambda: simple.Xdmf3ReaderT(FileName=[path])):
    source = reader()
    source.UpdatePipelineInformation()
    times = list(source.TimestepValues)
    assert len(times) == 5 and abs(times[4] - 4 / 72) < 1e-7, times
    for k, t in enumerate(times):
        source.UpdatePipeline(t)
        data, still = leaves(servermanager.Fetch(source))
        assert still.GetNumberOfPoints() == 4 and still.GetNumberOfCells() == 2 and still.GetPoint(2) == (1, -1, 1)
        assert data.GetNumberOfPoints() == 6 and data.GetNumberOfCells() == 4, (data.GetNumberOfPoints(), data.GetNumberOfCells())
        assert abs(data.GetPoint(1)[0] - (k + 0.03)) < 1e-6, (k, data.GetPoint(1))
    print("ok", source.GetXMLName())
