"""Wire fakes of the controllers of SIASUN's collaborative arms."""
